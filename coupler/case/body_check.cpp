// Judges what bodies are, but not where the given ones are: their densities and sizes, whether the backend
// can answer for their shapes, and the boxes of fills.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <set>

#include "adapters/automatic/collision_factory.hpp"
#include "coupler/case/case.hpp"
#include "coupler/case/case_check.hpp"
#include "coupler/case/case_sections.hpp"
#include "coupler/case/fill_room.hpp"
#include "coupler/case/limits.hpp"
#include "rigid/shapes/shape.hpp"

namespace silt::coupler {

namespace {

constexpr double most_density = 1e9;                 // times the fluid's
constexpr double low_ratio = 0.02, high_ratio = 50;  // of a body's density and the fluid's
// kg/m3: of solids from foam to osmium, of fluids from hydrogen to mercury
constexpr double lightest_solid = 10, heaviest_solid = 25000, lightest_fluid = 0.05, heaviest_fluid = 20000;
constexpr double cubic_centimetres = 1000;  // kg/m3 in g/cm3

bool is_of_a_solid(double density) {
  return density >= lightest_solid && density <= heaviest_solid;
}

/// What the density was perhaps meant to be; both in kg/m3.
std::string meant(const std::string& key, double density, double fluid) {
  if (is_of_a_solid(density * cubic_centimetres) && !is_of_a_solid(density))
    return fmt::format(": if {} is in g/cm3, write {} (kg/m3)", key, shown(density * cubic_centimetres));
  if (is_of_a_solid(fluid * cubic_centimetres) && is_of_a_solid(density))
    return fmt::format(": if fluid.density is in g/cm3, write {} (kg/m3)", shown(fluid * cubic_centimetres));
  if (!is_of_a_solid(density) && is_of_a_solid(density / cubic_centimetres))
    return fmt::format(": {} kg/m3 would be that of a solid", shown(density / cubic_centimetres));
  return "";
}

void check_ratio(const Case& scene, Findings& findings, const std::string& key, double density) {
  if (density >= low_ratio && density <= high_ratio) return;
  const std::string found = fmt::format("{} is {} times the fluid's; the method was measured from {} to {}",
                                        key, shown(density), low_ratio, high_ratio);
  if (scene.units.si)
    return findings.warning(
        key, found + meant(key, scene.units.physical(density, dimension::density), scene.units.density));
  findings.warning(key, found + ": in lattice units densities are relative to the fluid's");
}

void check_matter(const Case& scene, Findings& findings, const std::string& key, double density) {
  const double found = scene.units.physical(density, dimension::density);
  if (!scene.units.si || is_of_a_solid(found)) return;
  findings.warning(key, "{} is {} kg/m3; solids have {} to {}{}", key, shown(found), lightest_solid,
                   heaviest_solid, meant(key, found, 0));
}

/// The lightest density that explicit coupling bears depends on the shape.
void check_coupling(const Case& scene, Findings& findings, const std::string& key, double density,
                    int shape) {
  const double least = least_explicit_density(scene, scene.shapes[shape]);
  if (density >= least) return;
  findings.warning(key,
                   "{} is {} times the fluid's; with coupling.time = \"explicit\" shape '{}' is stable from "
                   "about {} on: use coupling.time = \"implicit\"",
                   key, shown(density), scene.shape_names[shape], shown(rounded_up(least)));
}

void check_density(const Case& scene, Findings& findings, const Entry& body) {
  const std::string key = body.key + ".density";
  const double density = body.density;
  if (density > most_density)
    return findings.error(key,
                          "{} is {} times the fluid's (1000 kg/m3 without a fluid); at most {} is possible: "
                          "lower it, or give the body motion = \"fixed\"",
                          key, shown(density), shown(most_density));
  if (!body.is_free() || !(density > 0)) return;
  if (scene.fluid)
    check_ratio(scene, findings, key, density), check_coupling(scene, findings, key, density, body.shape);
  else
    check_matter(scene, findings, key, density);
}

void check_fluid_density(const Case& scene, Findings& findings) {
  const double density = scene.units.density;
  if (!scene.units.si || !scene.fluid || (density >= lightest_fluid && density <= heaviest_fluid)) return;
  findings.warning("fluid.density",
                   "fluid.density is {} kg/m3; fluids have {} (a gas) to {} (mercury), water has 1000",
                   shown(density), lightest_fluid, heaviest_fluid);
}

}  // namespace

void find_density_faults(const Case& scene, Findings& findings) {
  check_fluid_density(scene, findings);
  for (const Entry& entry : entries_of(scene)) check_density(scene, findings, entry);
}

namespace {

constexpr double fewest_cells_across = 6;    // at 5 the drag of a dilute array is off by about 1 %
constexpr double fewest_cells_seen = 1;      // below, a body may lie between the centres of cells
constexpr double speck = 1e-3, dust = 1e-6;  // of the domain's length and volume
constexpr double millimetres = 1000;         // in a metre

double longest(const Case& scene) {
  return *std::max_element(scene.cells.begin(), scene.cells.end());
}

/// "; is it in millimetres? in m it is 0.004", where that would be a body that the domain and the lattice can
/// have.
std::string in_metres(const Case& scene, double across) {
  const double smaller = across / millimetres;
  if (!scene.units.si || smaller > longest(scene) || (scene.fluid && smaller < fewest_cells_seen)) return "";
  return fmt::format("; is it in millimetres? That would be {} m", shown_length(scene, smaller));
}

std::string cell_cure(const Case& scene, double across) {
  const double factor = across / fewest_cells_across;
  if (scene.units.si)
    return fmt::format("use units.cell_size = {}", shown(rounded_down(scene.units.cell_size * factor)));
  return fmt::format("make everything {} times as large", shown(rounded_up(1 / factor)));
}

void check_cells_across(const Case& scene, Findings& findings, const Entry& body) {
  const double across = rigid::least_width(scene.shapes[body.shape]);
  const std::string found = fmt::format("{}.shape: shape '{}' is {} cells across", body.key,
                                        scene.shape_names[body.shape], shown(across));
  if (across < fewest_cells_seen)
    findings.error(body.key + ".shape", "{}, which the lattice does not see; {}{}", found,
                   cell_cure(scene, across),
                   scene.units.si ? "" : ", or system = \"si\" if lengths are in m");
  else if (across < fewest_cells_across)
    findings.warning(body.key + ".shape", "{}; below {} its drag is inaccurate: {}", found,
                     fewest_cells_across, cell_cure(scene, across));
}

void check_specks(const Case& scene, Findings& findings, const Entry& body) {
  const rigid::Shape& shape = scene.shapes[body.shape];
  const double across = 2 * rigid::bounding_radius(shape);
  const double volume = std::max(1., double(body.count)) * rigid::mass_properties(shape).volume;
  const double domain = 1. * scene.cells[0] * scene.cells[1] * scene.cells[2];
  if (across > speck * longest(scene) || volume > dust * domain) return;
  findings.warning(
      body.key + ".shape",
      "{}.shape: shape '{}' is {} across, the domain {}: is domain.size, or the shape, in the unit of "
      "length of the case?",
      body.key, scene.shape_names[body.shape], shown_length(scene, across),
      shown_length(scene, longest(scene)));
}

/// What moves must find room between the walls.
bool fits(const Case& scene, Findings& findings, const Entry& body) {
  const double across = rigid::least_width(scene.shapes[body.shape]);
  for (int d = 0; d < 3; ++d) {
    const bool walls = !scene.periodic(d) && scene.boundary[2 * d].solid_for_bodies &&
                       scene.boundary[2 * d + 1].solid_for_bodies;
    if (!walls || across <= scene.cells[d] + 2 * start_overlap) continue;
    findings.error(body.key + ".shape",
                   "{}.shape: shape '{}' is {} across, but its domain only {} from wall to wall along {}{}",
                   body.key, scene.shape_names[body.shape], shown_length(scene, across),
                   shown_length(scene, scene.cells[d]), "xyz"[d], in_metres(scene, across));
    return false;
  }
  return true;
}

void check_images(const Case& scene, Findings& findings, const Entry& body) {
  const double across = 2 * rigid::bounding_radius(scene.shapes[body.shape]),
               reach = across + scene.contacts.margin;
  for (int d = 0; d < 3; ++d)
    if (scene.periodic(d) && reach > scene.cells[d])
      findings.error(
          body.key + ".shape",
          "{}.shape: shape '{}' with its contact margin reaches over {} cells, but the periodic axis {} "
          "has {}: the body would meet itself; lengthen the axis{}",
          body.key, scene.shape_names[body.shape], shown(reach), "xyz"[d], scene.cells[d],
          in_metres(scene, across));
}

void check_size(const Case& scene, Findings& findings, const Entry& body) {
  if (scene.fluid)
    check_cells_across(scene, findings, body);
  else
    check_specks(scene, findings, body);
  if (body.motion != rigid::Motion::fixed && fits(scene, findings, body)) check_images(scene, findings, body);
}

using rigid::Motion;
using rigid::Vec3;

std::string of_fill(std::size_t index, const char* key) {
  return fmt::format("fill[{}].{}", index, key);
}

void check_entries(const Case& scene, Findings& findings) {
  std::set<int> seen;
  scene.for_each_given([&](const BodySpec& body, std::uint64_t) {
    if (!seen.insert(body.entry).second) return;
    if (!(body.density > 0))
      findings.error(entry_key(body.entry) + ".density", "{}.density is {}; it must be above 0",
                     entry_key(body.entry), shown(body.density));
  });
  for (std::size_t i = 0; i < scene.fills.size(); ++i) {
    const FillSpec& fill = scene.fills[i];
    if (!(fill.density > 0))
      findings.error(of_fill(i, "density"), "fill[{}].density is {}; it must be above 0", i,
                     shown(fill.density));
    for (int d = 0; d < 3; ++d)
      if (fill.lower[d] < -start_overlap || fill.upper[d] > scene.cells[d] + start_overlap ||
          !(fill.lower[d] < fill.upper[d])) {
        findings.error(of_fill(i, "box"), "fill[{}].box is {} to {}; it must lie in the domain, {} to {}", i,
                       shown_point(scene, fill.lower), shown_point(scene, fill.upper),
                       shown_point(scene, Vec3::Zero()), shown_point(scene, extent_of(scene).size));
        break;
      }
  }
}

// How often a shape is used, and whether by anything that moves freely.
struct Use {
  std::int64_t count = 0;
  bool free = false;
};

std::vector<Use> uses_of(const Case& scene) {
  std::vector<Use> uses(scene.shapes.size());
  scene.for_each_given([&](const BodySpec& body, std::uint64_t count) {
    uses[body.shape].count += static_cast<std::int64_t>(count);
    uses[body.shape].free |= body.motion == Motion::free;
  });
  for (const FillSpec& fill : scene.fills) {
    uses[fill.shape].count += fill.count > 0 && fill.every == 0 ? fill.count : 2;  // of sites there are many
    uses[fill.shape].free = true;
  }
  return uses;
}

bool answers(const rigid::CollisionBackend& backend, const rigid::Shape& a, const rigid::Shape& b) {
  for (const rigid::Part& part_a : rigid::convex_parts(a))
    for (const rigid::Part& part_b : rigid::convex_parts(b))
      if (!backend.supports(part_a.shape, part_b.shape)) return false;
  return true;
}

// Every pair that can meet must have an answer.
void check_backend(const Case& scene, Findings& findings) {
  const auto backend = adapters::make_backend(scene.contacts.backend);
  const std::vector<Use> uses = uses_of(scene);
  std::size_t messages = 0;
  const auto check = [&](std::size_t i, const rigid::Shape& other, const std::string& other_name) {
    if (messages >= most_messages || answers(*backend, scene.shapes[i], other)) return;
    ++messages;
    findings.error("contacts.backend",
                   "contacts.backend is \"{}\"; it cannot answer contacts of shape '{}' ({}) with {}: use "
                   "another backend, or a simpler shape (polyhedra of at most some 10000 vertices)",
                   scene.contacts.backend, scene.shape_names[i], rigid::shape_name(scene.shapes[i]),
                   other_name);
  };
  const bool walls = std::any_of(scene.boundary.begin(), scene.boundary.end(),
                                 [](const BoundarySpec& side) { return side.solid_for_bodies; });
  for (std::size_t i = 0; i < uses.size(); ++i) {
    if (uses[i].free && walls) check(i, rigid::HalfSpace{Vec3::UnitZ()}, "a wall");
    for (std::size_t j = i; j < uses.size(); ++j)
      if ((uses[i].free || uses[j].free) && uses[i].count > 0 && uses[j].count > (i == j))
        check(i, scene.shapes[j],
              fmt::format("shape '{}' ({})", scene.shape_names[j], rigid::shape_name(scene.shapes[j])));
  }
}

// A fill whose bounding spheres are more than the densest packing of its box needs no try.
void check_fill_volumes(const Case& scene, Findings& findings) {
  const double densest = std::numbers::pi / std::sqrt(18);
  constexpr double sampling = 1.1;  // what walls leave is no less exact
  for (std::size_t i = 0; i < scene.fills.size(); ++i) {
    const FillSpec& fill = scene.fills[i];
    const double volume = rigid::mass_properties(scene.shapes[fill.shape]).volume;
    const double left = CurvedWalls(scene).share_left({fill.lower, fill.upper}, 0);
    const double room = std::min(1., sampling * left) * (fill.upper - fill.lower).prod();
    if (static_cast<double>(fill.count) * volume <= room * densest) continue;
    findings.error(
        of_fill(i, "count"),
        "fill[{}].count is {}: the bodies have {} times the volume of their box{}; at most {:.0f} can fit", i,
        fill.count, shown(static_cast<double>(fill.count) * volume / room),
        scene.walls.empty() ? "" : fmt::format(", of which walls leave {:.0f} %", 100 * left),
        room * densest / volume);
  }
}

void check_fill_rooms(const Case& scene, Findings& findings) {
  for (std::size_t i = 0; i < scene.fills.size(); ++i) try {
      const double radius = rigid::bounding_radius(scene.shapes[scene.fills[i].shape]);
      if (scene.fills[i].arrangement == Arrangement::random)
        room_for_centres(scene, i, radius);
      else
        lattice_of(scene, i, radius);
    } catch (const CaseError& error) {
      for (const Diagnostic& d : error.diagnostics()) findings.list.push_back(d);
    }
}

}  // namespace

void find_body_faults(const Case& scene, Findings& findings) {
  if (!scene.has_bodies()) return;
  const auto is_half_space = [&](const BodySpec& body) {
    if (!std::holds_alternative<rigid::HalfSpace>(scene.shapes[body.shape])) return false;
    findings.error(
        entry_key(body.entry) + ".shape",
        entry_key(body.entry) + ": a body cannot be a half-space; walls come from domain.boundary");
    return true;
  };
  if (scene.any_given(is_half_space)) return;
  check_entries(scene, findings);
  for (const Entry& entry : entries_of(scene)) check_size(scene, findings, entry);
  check_backend(scene, findings);
  check_fill_volumes(scene, findings);
  if (!has_errors(findings.list)) check_fill_rooms(scene, findings);
}

}  // namespace silt::coupler
