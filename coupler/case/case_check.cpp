#include "coupler/case/case_check.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "coupler/case/case.hpp"
#include "coupler/case/case_sections.hpp"
#include "coupler/case/limits.hpp"
#include "rigid/shapes/shape.hpp"

namespace silt::coupler {

std::string body_name(const Case& scene, rigid::BodyId id) {
  if (!rigid::is_wall(id)) return fmt::format("body {}", id);
  if (id < rigid::first_tube_id)
    return fmt::format("the side {}", side_names[Side(id - rigid::first_wall_id)]);
  return fmt::format("the wall '{}'", scene.walls[id - rigid::first_tube_id].name);
}

std::string entry_key(int entry) {
  return fmt::format("bodies[{}]", entry);
}

std::string position_key(const Case& scene, int entry) {
  const std::string key = entry_key(entry);
  return key + (scene.places.count(key + ".positions") ? ".positions" : ".position");
}

std::string position_text(const Case& scene, const BodySpec& body) {
  const std::string key = position_key(scene, body.entry);
  if (body.point == 0) return key;
  const auto filed = std::find_if(scene.filed.begin(), scene.filed.end(),
                                  [&](const FiledBodies& f) { return f.alike.entry == body.entry; });
  return fmt::format("{}, point {} of {}", key, body.point, filed->positions.name());
}

std::string shown_point(const Case& scene, const rigid::Vec3& x) {
  const double cell = scene.units.cell_size;
  return fmt::format("[{}, {}, {}]", shown(x[0] * cell), shown(x[1] * cell), shown(x[2] * cell));
}

std::string shown_length(const Case& scene, double x) {
  return shown(x * scene.units.cell_size);
}

void Findings::add(Diagnostic::Severity severity, const std::string& key, const std::string& text) {
  list.push_back({severity, scene.place(key), text});
}

namespace {

// A body that moves further in a sub-step than contacts reach ahead may be seen only when it overlaps
// another, and one that moves much further, not at all.
void check_margin(const Case& scene, Findings& findings, const std::string& key, double speed, int shape) {
  const double step = speed / scene.contacts.substeps, limit = MotionLimits(scene).of(shape);
  if (!scene.fluid && speed > limit)
    findings.error(key,
                   "{}: the body moves {} cells in a step; beyond {} it may pass through others: raise "
                   "contacts.substeps to {:.0f}{}",
                   key, shown(speed), shown(limit), std::ceil(speed / limit * scene.contacts.substeps),
                   scene.units.si ? ", or " + time_step_cure(scene, limit / speed) : "");
  else if (step > scene.contacts.margin)
    findings.warning(key,
                     "{}: the body moves {} cells in a sub-step, but contacts.margin is {}: it may overlap "
                     "others; raise contacts.margin or contacts.substeps",
                     key, shown(step), shown(scene.contacts.margin));
}

void check_speeds(const Case& scene, Findings& findings) {
  for (const Entry& entry : entries_of(scene)) {
    const double rim = rigid::bounding_radius(scene.shapes[entry.shape]) * entry.angular_velocity.norm();
    check_margin(scene, findings, entry.key + ".velocity", entry.velocity.norm(), entry.shape);
    if (!scene.fluid) continue;
    check_speed(findings, entry.key + ".velocity", entry.velocity.norm());
    if (rim > 0) check_speed(findings, entry.key + ".angular_velocity", rim);
  }
}

}  // namespace

std::vector<Diagnostic> check_case(const Case& scene) {
  Findings findings(scene);
  findings.list = scene.warnings;
  find_domain_faults(scene, findings);
  find_fluid_faults(scene, findings);
  find_contact_faults(scene, findings);
  find_run_faults(scene, findings);
  find_density_faults(scene, findings);
  find_quantity_faults(scene, findings);
  check_speeds(scene, findings);
  find_wall_faults(scene, findings);
  if (std::all_of(scene.cells.begin(), scene.cells.end(), [](int n) { return n > 0; }))
    find_body_faults(scene, findings), find_turnover_faults(scene, findings),
        find_driving_faults(scene, findings);
  return std::move(findings.list);
}

std::vector<Diagnostic> require_runnable(const Case& scene) {
  std::vector<Diagnostic> list = check_case(scene);
  if (!has_errors(list)) return list;
  std::erase_if(list, [](const Diagnostic& d) { return d.severity == Diagnostic::Severity::warning; });
  throw CaseError(std::move(list));
}

}  // namespace silt::coupler
