#include "coupler/guard.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <string_view>

#include "coupler/case/case.hpp"
#include "coupler/case/case_check.hpp"
#include "coupler/case/limits.hpp"
#include "coupler/flow_totals.hpp"
#include "coupler/place_text.hpp"
#include "coupler/scene.hpp"
#include "parallel/collectives.hpp"
#include "parallel/together.hpp"

namespace silt::coupler {

namespace {

std::string in_case_units(const Case& scene, double x, Dimension dimension, const char* si) {
  return scene.units.si ? fmt::format(" ({} {})", shown(scene.units.physical(x, dimension)), si) : "";
}

/// The keys of this case that set things in motion, at most one a section: "fluid.body_force,
/// bodies[0].velocity".
std::string drives(const Case& scene) {
  constexpr std::array<std::string_view, 5> names = {"acceleration", "body_force", "velocity",
                                                     "angular_velocity", "amplitude"};
  std::string listed, last;
  for (const auto& [path, place] : scene.places) {
    const std::string section = path.substr(0, path.find_first_of(".["));
    const auto name = std::string_view(path).substr(path.rfind('.') + 1);
    if (section == last || std::find(names.begin(), names.end(), name) == names.end()) continue;
    listed += (listed.empty() ? "" : ", ") + path;
    last = section;
  }
  return listed;
}

std::string slower_remedy(const Case& scene) {
  const std::string shorter = shorter_step(scene), driven = drives(scene);
  return fmt::format("{}lower what drives it{}", shorter.empty() ? "" : fmt::format("use {}, or ", shorter),
                     driven.empty() ? "" : fmt::format(" ({})", driven));
}

const char* const light_bodies_remedy = "use coupling.time = \"implicit\" (light bodies need it), or ";

/// What to change when a flow runs away: explicit coupling of light bodies; the collision or the relaxation
/// time if that is close to 1/2, where trt and bgk do not last; else the time step or the drive.
std::string flow_remedy(const Case& scene) {
  constexpr double delicate_relaxation_time = 0.55;
  if (has_bodies_too_light(scene)) return light_bodies_remedy + slower_remedy(scene);
  const double tau = scene.fluid->relaxation_time;
  if (tau >= delicate_relaxation_time || lbm::model_of(scene.fluid->collision).has_eddies())
    return slower_remedy(scene);
  return fmt::format(
      "the relaxation time is {}, close to its limit of 0.5: use fluid.collision = \"regularised\", or "
      "raise {}",
      shown(tau),
      scene.places.count("fluid.kinematic_viscosity")
          ? fmt::format("fluid.kinematic_viscosity{}",
                        scene.units.si ? ", or use a smaller units.cell_size" : "")
          : "fluid.relaxation_time");
}

std::string speed_remedy(const Case& scene, double too_far, std::int64_t step) {
  if (scene.fluid)
    return (scene.coupling.time == TimeCoupling::explicit_ ? light_bodies_remedy : "") + slower_remedy(scene);
  if (step > 0 && rigid::resolver_model(scene.contacts.resolver).makes_energy) return contact_remedy(scene);
  const std::string shorter = shorter_step(scene);
  return fmt::format("beyond that it may pass through others: use contacts.substeps = {:.0f}{}",
                     std::ceil(too_far * scene.contacts.substeps), shorter.empty() ? "" : " or " + shorter);
}

/// What moves the fluid at a cell: a body beside it that is about as fast, else the flow itself.
std::string remedy_at(const Scene& scene, const Neighbours& near, double speed) {
  const rigid::BodySet& bodies = scene.bodies;
  if (!near.first || near.first->row >= bodies.first_wall()) return flow_remedy(scene.setup);
  const std::size_t row = near.first->row;
  const double body = bodies.velocity[row].norm();
  if (body < 0.5 * std::min(speed, highest_speed)) return flow_remedy(scene.setup);
  return fmt::format("the body moves {} cells in a step{}: {}", shown(body),
                     in_case_units(scene.setup, body, dimension::velocity, "m/s"),
                     speed_remedy(scene.setup, 1, 0));
}

std::string fluid_text(const Scene& scene, lbm::Int3 cell, const std::string& what, double speed) {
  const Neighbours near = neighbours_of(scene, cell);
  return fmt::format("the fluid at {}{}; {}", place_text(scene, cell, near), what,
                     remedy_at(scene, near, speed));
}

std::string speed_text(const Case& scene, double speed, double limit) {
  return fmt::format(", moves {} cells in a step{}; at most {} is possible", shown(speed),
                     in_case_units(scene, speed, dimension::velocity, "m/s"), shown(limit));
}

/// The cell at fault and what is wrong with it, if anything is.
struct FluidFault {
  lbm::Int3 cell;
  std::string what;
};
std::optional<FluidFault> fault_of(const Case& scene, const FlowTotals& totals) {
  if (!totals.finite) return FluidFault{totals.bad_cell, ", is not a number"};
  if (!(totals.max_speed <= highest_speed))
    return FluidFault{totals.fastest_cell, speed_text(scene, totals.max_speed, highest_speed)};
  if (!(totals.min_density > 0))
    return FluidFault{
        totals.thinnest_cell,
        fmt::format(", has {} of its reference density; it must be above 0", shown(totals.min_density))};
  return {};
}

bool holds(const FluidFields& fields, lbm::Int3 cell) {
  for (int b = 0; b < fields.blocks(); ++b)
    if (fields.block(b).contains(cell)) return true;
  return false;
}

}  // namespace

void check_flow(const Scene& scene, const FlowTotals& totals, std::int64_t step) {
  const std::optional<FluidFault> fault = fault_of(scene.setup, totals);
  if (!fault) return;
  const std::string here = holds(scene.flow->fields(), fault->cell)
                               ? fluid_text(scene, fault->cell, fault->what, totals.max_speed)
                               : "";
  throw CommonGuardStop(fmt::format("step {}: {}", step, parallel::text_of_first(scene.comm, here)));
}

std::string contact_remedy(const Case& scene) {
  if (rigid::resolver_model(scene.contacts.resolver).makes_energy)
    return fmt::format("contacts.resolver = \"{}\" makes energy where several bodies meet: use \"{}\"",
                       scene.contacts.resolver, rigid::resolver_models().front().name);
  const std::string shorter = shorter_step(scene);
  return fmt::format("raise contacts.substeps (now {}){}", scene.contacts.substeps,
                     shorter.empty() ? "" : ", or use " + shorter);
}

std::string too_fast_text(const Scene& scene, const FluidFields::Fast& fast, std::int64_t step) {
  const std::string what = std::isfinite(fast.speed)
                               ? speed_text(scene.setup, fast.speed, lbm::speed_of_sound)
                               : ", is not a number";
  return fmt::format("step {}: {}", step, fluid_text(scene, fast.cell, what, fast.speed));
}

std::string motion_text(const Case& scene, rigid::BodyId id, double speed, double limit, std::int64_t step) {
  if (!std::isfinite(speed))
    return fmt::format("step {}: position or velocity of body {} is not a number; {}", step, id,
                       scene.fluid ? flow_remedy(scene) : contact_remedy(scene));
  return fmt::format("step {}: body {} moves {} cells in a step{}; at most {} is possible: {}", step, id,
                     shown(speed), in_case_units(scene, speed, dimension::velocity, "m/s"), shown(limit),
                     speed_remedy(scene, speed / limit, step));
}

std::string overlap_text(const Case& scene, const rigid::Contact& c, double half_width, std::int64_t step) {
  std::string remedy = contact_remedy(scene);
  if (!rigid::resolver_model(scene.contacts.resolver).makes_energy) {
    const std::string shorter = shorter_step(scene);
    remedy = fmt::format(
        "raise contacts.sweeps (now {}) or contacts.substeps (now {}){}, or use densities that "
        "differ less",
        scene.contacts.resolver_settings.max_sweeps, scene.contacts.substeps,
        shorter.empty() ? "" : ", use " + shorter);
  }
  return fmt::format(
      "step {}: {} and {} overlap by {}{}, deeper than half the width of one ({}), and contacts do not hold "
      "them; {}",
      step, body_name(scene, c.a), body_name(scene, c.b), shown(-c.gap),
      in_case_units(scene, -c.gap, dimension::length, "m"), shown(half_width), remedy);
}

std::string overflow_text(const Case& scene, const std::string& what, std::int64_t step,
                          std::optional<int> rank) {
  return fmt::format("step {}: a force is out of range{} ({}); {}", step,
                     rank ? fmt::format(" on rank {}", *rank) : "", what,
                     scene.fluid ? flow_remedy(scene) : contact_remedy(scene));
}

}  // namespace silt::coupler
