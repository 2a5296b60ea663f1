#include "coupler/case/case_check.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "coupler/case/case.hpp"
#include "coupler/case/case_sections.hpp"
#include "coupler/case/limits.hpp"
#include "rigid/shapes/shape.hpp"

namespace silt::coupler {

std::string body_name(const Case& setup, rigid::BodyId id) {
  if (!rigid::is_wall(id)) return fmt::format("body {}", id);
  if (id < rigid::first_tube_id)
    return fmt::format("the side {}", side_names[Side(id - rigid::first_wall_id)]);
  return fmt::format("the wall '{}'", setup.walls[id - rigid::first_tube_id].name);
}

std::string entry_key(int entry) {
  return fmt::format("bodies[{}]", entry);
}

std::string position_key(const Case& setup, int entry) {
  const std::string key = entry_key(entry);
  return key + (setup.places.count(key + ".positions") ? ".positions" : ".position");
}

std::string position_text(const Case& setup, const BodySpec& body) {
  const std::string key = position_key(setup, body.entry);
  if (body.point == 0) return key;
  const auto filed = std::find_if(setup.filed.begin(), setup.filed.end(),
                                  [&](const FiledBodies& f) { return f.alike.entry == body.entry; });
  return fmt::format("{}, point {} of {}", key, body.point, filed->positions.name());
}

std::string shown(const rigid::Vec3& x) {
  return fmt::format("[{}, {}, {}]", shown(x[0]), shown(x[1]), shown(x[2]));
}

std::string shown_point(const Case& setup, const rigid::Vec3& x) {
  return shown(rigid::Vec3(x * setup.units.cell_size));
}

std::string shown_box(const Case& setup, const rigid::BoundingBox& box) {
  return fmt::format("{} to {}", shown_point(setup, box.lower), shown_point(setup, box.upper));
}

bool lies_in_domain(const Case& setup, const rigid::BoundingBox& box, double slack) {
  const rigid::BoundingBox domain = box_of(setup);
  return (box.lower.array() >= domain.lower.array() - slack).all() &&
         (box.upper.array() <= domain.upper.array() + slack).all();
}

std::string shown_length(const Case& setup, double x) {
  return shown(x * setup.units.cell_size);
}

void Findings::add(Diagnostic::Severity severity, const std::string& key, const std::string& text) {
  list.push_back({severity, setup.place(key), text});
}

namespace {

// A body that moves further in a sub-step than contacts reach ahead may be seen only when it overlaps
// another, and one that moves much further, not at all.
void check_margin(const Case& setup, Findings& findings, const std::string& key, double speed, int shape) {
  const double step = speed / setup.contacts.substeps, limit = MotionLimits(setup).of(shape);
  if (!setup.fluid && speed > limit)
    findings.error(key,
                   "{}: the body moves {} cells in a step; beyond {} it may pass through others: raise "
                   "contacts.substeps to {:.0f}{}",
                   key, shown(speed), shown(limit), std::ceil(speed / limit * setup.contacts.substeps),
                   setup.units.si ? ", or " + time_step_cure(setup, limit / speed) : "");
  else if (step > setup.contacts.margin)
    findings.warning(key,
                     "{}: the body moves {} cells in a sub-step, but contacts.margin is {}: it may overlap "
                     "others; raise contacts.margin or contacts.substeps",
                     key, shown(step), shown(setup.contacts.margin));
}

void check_speeds(const Case& setup, Findings& findings) {
  for (const Entry& entry : entries_of(setup)) {
    const double rim = rigid::bounding_radius(setup.shapes[entry.shape]) * entry.angular_velocity.norm();
    check_margin(setup, findings, entry.key + ".velocity", entry.velocity.norm(), entry.shape);
    if (!setup.fluid) continue;
    check_speed(findings, entry.key + ".velocity", entry.velocity.norm());
    if (rim > 0) check_speed(findings, entry.key + ".angular_velocity", rim);
    if (const auto found = setup.kind_motions.find(entry.kind);
        found != setup.kind_motions.end() && entry.motion == rigid::Motion::prescribed)
      check_speed(findings, entry.key + ".motion",
                  found->second.speed_bound(rigid::bounding_radius(setup.shapes[entry.shape])));
  }
}

}  // namespace

std::vector<Diagnostic> check_case(const Case& setup) {
  Findings findings(setup);
  findings.list = setup.warnings;
  find_domain_faults(setup, findings);
  find_fluid_faults(setup, findings);
  find_contact_faults(setup, findings);
  find_run_faults(setup, findings);
  find_density_faults(setup, findings);
  find_quantity_faults(setup, findings);
  check_speeds(setup, findings);
  find_wall_faults(setup, findings);
  find_body_faults(setup, findings);
  find_turnover_faults(setup, findings);
  find_driving_faults(setup, findings);
  find_spring_faults(setup, findings);
  find_coarsening_faults(setup, findings);
  return std::move(findings.list);
}

std::vector<Diagnostic> require_runnable(const Case& setup) {
  std::vector<Diagnostic> list = check_case(setup);
  if (!has_errors(list)) return list;
  std::erase_if(list, [](const Diagnostic& d) { return d.severity == Diagnostic::Severity::warning; });
  throw CaseError(std::move(list));
}

}  // namespace silt::coupler
