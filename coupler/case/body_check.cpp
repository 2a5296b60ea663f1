#include "coupler/case/body_check.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <set>

#include "adapters/automatic/collision_factory.hpp"
#include "coupler/case/body_text.hpp"
#include "coupler/case/case.hpp"
#include "coupler/case/case_extent.hpp"
#include "coupler/case/curved_walls.hpp"
#include "coupler/case/fill_room.hpp"
#include "coupler/case/lattice.hpp"
#include "coupler/case/size_check.hpp"
#include "rigid/shapes/shape.hpp"

namespace silt::coupler {
namespace {

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
      findings.error(
          entry_key(body.entry) + ".density",
          fmt::format("{}.density is {}; it must be above 0", entry_key(body.entry), shown(body.density)));
  });
  for (std::size_t i = 0; i < scene.fills.size(); ++i) {
    const FillSpec& fill = scene.fills[i];
    if (!(fill.density > 0))
      findings.error(of_fill(i, "density"),
                     fmt::format("fill[{}].density is {}; it must be above 0", i, shown(fill.density)));
    for (int d = 0; d < 3; ++d)
      if (fill.lower[d] < -start_overlap || fill.upper[d] > scene.cells[d] + start_overlap ||
          !(fill.lower[d] < fill.upper[d])) {
        findings.error(
            of_fill(i, "box"),
            fmt::format("fill[{}].box is {} to {}; it must lie in the domain, {} to {}", i,
                        shown_point(scene, fill.lower), shown_point(scene, fill.upper),
                        shown_point(scene, Vec3::Zero()), shown_point(scene, extent_of(scene).size)));
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
    findings.error(
        "contacts.backend",
        fmt::format("contacts.backend is \"{}\"; it cannot answer contacts of shape '{}' ({}) with {}: "
                    "use another backend, or a simpler shape (polyhedra of at most some 10000 vertices)",
                    scene.contacts.backend, scene.shape_names[i], rigid::shape_name(scene.shapes[i]),
                    other_name));
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
        fmt::format("fill[{}].count is {}: the bodies have {} times the volume of their "
                    "box{}; at most {:.0f} can fit",
                    i, fill.count, shown(static_cast<double>(fill.count) * volume / room),
                    scene.walls.empty() ? "" : fmt::format(", of which walls leave {:.0f} %", 100 * left),
                    room * densest / volume));
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

void Findings::add(Diagnostic::Severity severity, const std::string& key, const std::string& text) {
  list.push_back({severity, scene.place(key), text});
}

void find_body_faults(const Case& scene, Findings& findings) {
  if (!scene.has_bodies()) return;
  const auto is_half_space = [&](const BodySpec& body) {
    if (!std::holds_alternative<rigid::HalfSpace>(scene.shapes[body.shape])) return false;
    findings.error(entry_key(body.entry) + ".shape", entry_key(body.entry) +
                                                         ": a body cannot be a half-space; walls come from "
                                                         "domain.boundary");
    return true;
  };
  if (scene.any_given(is_half_space)) return;
  check_entries(scene, findings);
  find_size_faults(scene, findings);
  check_backend(scene, findings);
  check_fill_volumes(scene, findings);
  if (!has_errors(findings.list)) check_fill_rooms(scene, findings);
}

}  // namespace silt::coupler
