#include "coupler/case/size_check.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "coupler/case/body_text.hpp"
#include "coupler/case/case.hpp"
#include "coupler/case/time_step_cure.hpp"
#include "rigid/shapes/shape.hpp"

namespace silt::coupler {
namespace {

using rigid::Motion;

constexpr double fewest_cells_across = 6;    // at 5 the drag of a dilute array is off by about 1 %
constexpr double fewest_cells_seen = 1;      // below, a body may lie between the centres of cells
constexpr double speck = 1e-3, dust = 1e-6;  // of the domain's length and volume
constexpr double millimetres = 1000;         // in a metre

/// Bodies of one entry.
struct Sized {
  std::string key;  // of the entry's shape
  int shape;
  Motion motion;
  double count;
};

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

void check_cells_across(const Case& scene, Findings& findings, const Sized& body) {
  const double across = rigid::least_width(scene.shapes[body.shape]);
  const std::string found = fmt::format("{}: shape '{}' is {} cells across", body.key,
                                        scene.shape_names[body.shape], shown(across));
  if (across < fewest_cells_seen)
    findings.error(body.key,
                   fmt::format("{}, which the lattice does not see; {}{}", found, cell_cure(scene, across),
                               scene.units.si ? "" : ", or system = \"si\" if lengths are in m"));
  else if (across < fewest_cells_across)
    findings.warning(body.key, fmt::format("{}; below {} its drag is inaccurate: {}", found,
                                           fewest_cells_across, cell_cure(scene, across)));
}

void check_specks(const Case& scene, Findings& findings, const Sized& body) {
  const rigid::Shape& shape = scene.shapes[body.shape];
  const double across = 2 * rigid::bounding_radius(shape);
  const double volume = body.count * rigid::mass_properties(shape).volume;
  const double domain = 1. * scene.cells[0] * scene.cells[1] * scene.cells[2];
  if (across > speck * longest(scene) || volume > dust * domain) return;
  findings.warning(
      body.key,
      fmt::format("{}: shape '{}' is {} across, the domain {}: is domain.size, or the shape, in the "
                  "unit of length of the case?",
                  body.key, scene.shape_names[body.shape], shown_length(scene, across),
                  shown_length(scene, longest(scene))));
}

/// What moves must find room between the walls.
bool fits(const Case& scene, Findings& findings, const Sized& body) {
  const double across = rigid::least_width(scene.shapes[body.shape]);
  for (int d = 0; d < 3; ++d) {
    const bool walls = !scene.periodic(d) && scene.boundary[2 * d].solid_for_bodies &&
                       scene.boundary[2 * d + 1].solid_for_bodies;
    if (!walls || across <= scene.cells[d] + 2 * start_overlap) continue;
    findings.error(body.key,
                   fmt::format("{}: shape '{}' is {} across, but its domain only {} from wall to wall along "
                               "{}{}",
                               body.key, scene.shape_names[body.shape], shown_length(scene, across),
                               shown_length(scene, scene.cells[d]), "xyz"[d], in_metres(scene, across)));
    return false;
  }
  return true;
}

void check_images(const Case& scene, Findings& findings, const Sized& body) {
  const double across = 2 * rigid::bounding_radius(scene.shapes[body.shape]),
               reach = across + scene.contacts.margin;
  for (int d = 0; d < 3; ++d)
    if (scene.periodic(d) && reach > scene.cells[d])
      findings.error(
          body.key,
          fmt::format("{}: shape '{}' with its contact margin reaches over {} cells, but the periodic "
                      "axis {} has {}: the body would meet itself; lengthen the axis{}",
                      body.key, scene.shape_names[body.shape], shown(reach), "xyz"[d], scene.cells[d],
                      in_metres(scene, across)));
}

void check_size(const Case& scene, Findings& findings, const Sized& body) {
  if (scene.fluid)
    check_cells_across(scene, findings, body);
  else
    check_specks(scene, findings, body);
  if (body.motion != Motion::fixed && fits(scene, findings, body)) check_images(scene, findings, body);
}

}  // namespace

void find_size_faults(const Case& scene, Findings& findings) {
  std::vector<Sized> entries;
  scene.for_each_given([&](const BodySpec& body, std::uint64_t count) {
    const std::string key = entry_key(body.entry) + ".shape";
    if (entries.empty() || entries.back().key != key) entries.push_back({key, body.shape, body.motion, 0});
    entries.back().count += static_cast<double>(count);
  });
  for (std::size_t i = 0; i < scene.fills.size(); ++i) {
    const FillSpec& fill = scene.fills[i];
    entries.push_back({fmt::format("fill[{}].shape", i), fill.shape, Motion::free,
                       std::max(1., static_cast<double>(fill.count))});
  }
  for (const Sized& entry : entries) check_size(scene, findings, entry);
}

}  // namespace silt::coupler
