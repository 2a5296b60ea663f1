#include "coupler/case/case_check.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "coupler/case/body_check.hpp"
#include "coupler/case/boundary_check.hpp"
#include "coupler/case/case.hpp"
#include "coupler/case/contact_check.hpp"
#include "coupler/case/density_check.hpp"
#include "coupler/case/driving_check.hpp"
#include "coupler/case/fluid_check.hpp"
#include "coupler/case/motion_limits.hpp"
#include "coupler/case/quantity_types.hpp"
#include "coupler/case/speed_check.hpp"
#include "coupler/case/time_step_cure.hpp"
#include "coupler/case/turnover_check.hpp"
#include "coupler/case/wall_check.hpp"
#include "rigid/shapes/shape.hpp"

namespace silt::coupler {
namespace {

constexpr double most_steps = 1e15;
constexpr int thinnest_block = 2;  // cells: a block needs a layer to send to either side

void check_domain(const Case& scene, Findings& findings) {
  for (int d = 0; d < 3; ++d) {
    if (scene.cells[d] < 1)
      findings.error("domain.size", fmt::format("the domain has {} cells along {}; it must have at least 1",
                                                scene.cells[d], "xyz"[d]));
    if (!scene.block_cells) continue;
    const int block = (*scene.block_cells)[d];
    if (block < std::min(thinnest_block, scene.cells[d]))
      findings.error("domain.blocks", fmt::format("domain.blocks[{}] is {}; it must be at least {} cells", d,
                                                  block, thinnest_block));
    else if (block > scene.cells[d])
      findings.warning("domain.blocks",
                       fmt::format("domain.blocks[{}] is {} cells; the domain has only {} along {}", d, block,
                                   scene.cells[d], "xyz"[d]));
  }
}

// A body that moves further in a sub-step than contacts reach ahead may be seen only when it overlaps
// another, and one that moves much further, not at all.
void check_margin(const Case& scene, Findings& findings, const std::string& key, double speed, int shape) {
  const double step = speed / scene.contacts.substeps, limit = MotionLimits(scene).of(shape);
  if (!scene.fluid && speed > limit)
    findings.error(
        key, fmt::format("{}: the body moves {} cells in a step; beyond {} it may pass through "
                         "others: raise contacts.substeps to {:.0f}{}",
                         key, shown(speed), shown(limit), std::ceil(speed / limit * scene.contacts.substeps),
                         scene.units.si ? ", or " + time_step_cure(scene, limit / speed) : ""));
  else if (step > scene.contacts.margin)
    findings.warning(
        key,
        fmt::format("{}: the body moves {} cells in a sub-step, but contacts.margin is {}: it may overlap "
                    "others; raise contacts.margin or contacts.substeps",
                    key, shown(step), shown(scene.contacts.margin)));
}

void check_body_speeds(const Case& scene, Findings& findings) {
  std::vector<int> seen;
  scene.for_each_given([&](const BodySpec& body, std::uint64_t) {
    if (std::count(seen.begin(), seen.end(), body.entry)) return;  // one message an entry
    seen.push_back(body.entry);
    const double rim = rigid::bounding_radius(scene.shapes[body.shape]) * body.angular_velocity.norm();
    const std::string entry = fmt::format("bodies[{}]", std::max(0, body.entry));
    check_margin(scene, findings, entry + ".velocity", body.velocity.norm(), body.shape);
    if (!scene.fluid) return;
    check_speed(findings, entry + ".velocity", body.velocity.norm());
    if (rim > 0) check_speed(findings, entry + ".angular_velocity", rim);
  });
}

void check_fill_speeds(const Case& scene, Findings& findings) {
  for (std::size_t i = 0; i < scene.fills.size(); ++i) {
    const std::string key = fmt::format("fill[{}].velocity", i);
    const double speed = scene.fills[i].velocity.norm();
    check_margin(scene, findings, key, speed, scene.fills[i].shape);
    if (scene.fluid) check_speed(findings, key, speed);
  }
}

void check_steady(const Case& scene, Findings& findings) {
  constexpr int looks_needed = 4;
  if (!scene.steady) return;
  std::vector<std::string> names;
  for (const QuantitySpec& quantity : scene.quantities) names.push_back(quantity.name);
  const std::string& name = scene.steady->quantity;
  if (std::find(names.begin(), names.end(), name) == names.end())
    findings.error("run.steady.quantity",
                   fmt::format("run.steady.quantity: there is no quantity '{}' in [[quantities]]{}", name,
                               names.empty() ? "" : suggestion(name, names)));
  if (scene.steady->every > scene.steps / looks_needed)
    findings.warning("run.steady.every",
                     fmt::format("run.steady.every is {}, of {} steps in all: there will be less than the {} "
                                 "looks it takes to see that something is steady",
                                 scene.steady->every, scene.steps, looks_needed));
}

void check_run(const Case& scene, Findings& findings) {
  if (scene.steps < 1)
    findings.error("run.steps", fmt::format("the run has {} steps; it must have at least 1", scene.steps));
  if (static_cast<double>(scene.steps) > most_steps)
    findings.error("run.steps", fmt::format("the run has {} steps; at most {} are possible: shorten it",
                                            scene.steps, shown(most_steps)));
  check_steady(scene, findings);
  if (!scene.fluid && !scene.has_bodies())
    findings.error("", "the case has neither a [fluid] nor bodies: there is nothing to compute");
  const bool flat = std::find(scene.cells.begin(), scene.cells.end(), 1) != scene.cells.end();
  if (scene.fluid && flat && (scene.output.fields.every > 0 || !scene.output.slices.empty()))
    findings.warning("output",
                     "the domain is one cell thick, and VTK and ParaView end with an error on fields "
                     "as flat as that: make domain.size two cells thick");
  if (!scene.fluid && !scene.output.slices.empty())
    findings.error("output.slices",
                   "output.slices asks for fields of the fluid, but the case has no [fluid]; remove it");
  if (!scene.fluid && scene.output.fields.every > 0)
    findings.error("output.fields",
                   "output.fields asks for fields of the fluid, but the case has no [fluid]; remove it");
  if (!scene.has_bodies() && scene.output.bodies.every > 0)
    findings.warning("output.bodies", "output.bodies asks for bodies, but the case has none");
}

void check_sampled_box(const Case& scene, Findings& findings, const QuantitySpec& quantity,
                       const std::string& key) {
  for (int d = 0; d < 3; ++d)
    if (quantity.lower[d] < 0 || quantity.upper[d] > scene.cells[d])
      return findings.error(
          key, fmt::format("{} reaches from {} to {} along {}; it must lie in the domain, 0 to {}", key,
                           shown(quantity.lower[d] * scene.units.cell_size),
                           shown(quantity.upper[d] * scene.units.cell_size), "xyz"[d],
                           shown(scene.cells[d] * scene.units.cell_size)));
}

// What a quantity needs and the scene has not.
std::string lacking(const Case& scene, const QuantityType& type) {
  using Q = QuantityType;
  if (type.asks_for(Q::fluid) && !scene.fluid) return "the case has no [fluid]";
  if (type.asks_for(Q::bodies) && !scene.has_bodies()) return "the case has no bodies";
  if (type.asks_for(Q::gravity) && scene.gravity.norm() == 0) return "the case has no [gravity]";
  const bool driven =
      scene.any_given([](const BodySpec& b) { return b.motion == rigid::Motion::prescribed; });
  if (type.asks_for(Q::same_bodies) && (scene.bodies_come() || scene.bodies_leave()))
    return "bodies come or leave, of which it knows nothing";
  if (type.asks_for(Q::undriven) && driven)
    return "the case has a body of prescribed motion, which drives the others";
  return "";
}

bool is_wall(const BoundarySpec& side) {
  return side.kind == BoundaryKind::no_slip || side.kind == BoundaryKind::moving;
}

void check_side(const Case& scene, Findings& findings, const QuantitySpec& quantity, const std::string& key) {
  if (is_wall(scene.boundary[quantity.side])) return;
  findings.error(key, fmt::format("{} is {}, which is no wall; it must be a side that is no-slip or moving",
                                  key, side_key(quantity.side)));
}

void check_shear(const Case& scene, Findings& findings, const QuantitySpec& quantity,
                 const std::string& key) {
  const BoundarySpec &low = scene.boundary[2 * quantity.axis], &high = scene.boundary[2 * quantity.axis + 1];
  if (is_wall(low) && is_wall(high) && low.velocity != high.velocity) return;
  findings.error(key, fmt::format("{} is {}, across which nothing is sheared; both sides there must be walls "
                                  "(no-slip or moving), of different velocities",
                                  key, "xyz"[quantity.axis]));
}

void check_quantities(const Case& scene, Findings& findings) {
  for (std::size_t i = 0; i < scene.quantities.size(); ++i) {
    const QuantitySpec& quantity = scene.quantities[i];
    const QuantityType& type = quantity_type(quantity.type);
    const std::string entry = fmt::format("quantities[{}]", i), lack = lacking(scene, type);
    if (!lack.empty())
      findings.error(entry + ".type", fmt::format("{}.type is \"{}\", but {}", entry, quantity.type, lack));
    const bool never = type.takes(QuantityType::time)
                           ? quantity.time >= static_cast<double>(scene.steps)
                           : type.takes(QuantityType::instant) && std::isfinite(quantity.time) &&
                                 quantity.time > static_cast<double>(scene.steps);
    if (never)
      findings.warning(
          entry + ".time",
          fmt::format("{}.time is not before the end of the run: the quantity will have no value", entry));
    if (type.takes(QuantityType::side)) check_side(scene, findings, quantity, entry + ".side");
    if (type.asks_for(QuantityType::sheared)) check_shear(scene, findings, quantity, entry + ".axis");
    if (type.takes(QuantityType::box)) check_sampled_box(scene, findings, quantity, entry + ".box");
  }
}

}  // namespace

std::vector<Diagnostic> check_case(const Case& scene) {
  Findings findings(scene);
  findings.list = scene.warnings;
  check_domain(scene, findings);
  find_boundary_faults(scene, findings);
  find_fluid_faults(scene, findings);
  find_contact_faults(scene, findings);
  check_run(scene, findings);
  find_density_faults(scene, findings);
  check_quantities(scene, findings);
  check_body_speeds(scene, findings);
  check_fill_speeds(scene, findings);
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
