#include "coupler/guard.hpp"

#include <fmt/format.h>

#include <cmath>

namespace silt::coupler {

namespace {

std::string in_case_units(const Case& scene, double x, Dimension dimension, const char* si) {
  return scene.units.si ? fmt::format(" ({} {})", shown(scene.units.physical(x, dimension)), si) : "";
}

/// What to change when a flow runs away: the relaxation time if it is close to 1/2, else the time step or the
/// drive.
std::string flow_remedy(const Case& scene) {
  constexpr double delicate_relaxation_time = 0.55;
  const double tau = scene.fluid->relaxation_time;
  if (tau < delicate_relaxation_time)
    return fmt::format("the relaxation time is {}, close to its limit of 0.5: raise {}", shown(tau),
                       scene.units.si ? "fluid.kinematic_viscosity, or use a smaller units.cell_size"
                                      : "fluid.relaxation_time");
  return scene.units.si ? "use a smaller units.time_step, or lower what drives the flow"
                        : "lower what drives the flow: velocities, fluid.body_force or gravity.acceleration";
}

}  // namespace

void check_flow(const Case& scene, const FlowTotals& totals, std::int64_t step) {
  const auto stop = [&](const std::string& found) {
    throw GuardStop(fmt::format("step {}: {}; {}", step, found, flow_remedy(scene)));
  };
  if (!totals.finite)
    stop(fmt::format("the fluid at cell [{}, {}, {}] is not a number", totals.bad_cell[0], totals.bad_cell[1],
                     totals.bad_cell[2]));
  if (!(totals.max_speed <= highest_speed))
    stop(fmt::format("the fluid's largest speed is {} cells a step{}; at most {} is possible",
                     shown(totals.max_speed),
                     in_case_units(scene, totals.max_speed, dimension::velocity, "m/s"), highest_speed));
  if (!(totals.min_density > 0))
    stop(fmt::format("the fluid's smallest density is {} of its reference; it must be above 0",
                     shown(totals.min_density)));
}

void check_bodies(const Case& scene, const rigid::BodySet& bodies, std::int64_t step, int rank) {
  for (std::size_t row = 0; row < bodies.owned; ++row) {
    const double speed = bodies.velocity[row].norm();
    const double sum =
        speed + bodies.angular_velocity[row].squaredNorm() + bodies.position[row].squaredNorm();
    if (!std::isfinite(sum))
      throw GuardStop(fmt::format("step {}: position or velocity of body {} (rank {}) is not a number; {}",
                                  step, bodies.id[row], rank,
                                  scene.fluid ? flow_remedy(scene) : "use a smaller units.time_step"));
    if (scene.fluid && speed > furthest_motion)
      throw GuardStop(fmt::format(
          "step {}: body {} (rank {}) moves {} cells in a step{}; at most {} is possible: use {}a smaller {}",
          step, bodies.id[row], rank, shown(speed), in_case_units(scene, speed, dimension::velocity, "m/s"),
          furthest_motion,
          scene.coupling.time == TimeCoupling::explicit_
              ? "coupling.time = \"implicit\" (light bodies need it) or "
              : "",
          scene.units.si ? "units.time_step" : "gravity.acceleration or velocity"));
  }
}

std::string overflow_text(const Case& scene, const std::string& what, std::int64_t step, int rank) {
  return fmt::format("step {}: a force on a body is out of range on rank {} ({}); {}", step, rank, what,
                     scene.fluid ? flow_remedy(scene) : "use a smaller units.time_step");
}

}  // namespace silt::coupler
