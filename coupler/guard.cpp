#include "coupler/guard.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "coupler/case/case.hpp"
#include "coupler/flow_totals.hpp"
#include "rigid/bodies/body_set.hpp"

namespace silt::coupler {

namespace {

std::string in_case_units(const Case& scene, double x, Dimension dimension, const char* si) {
  return scene.units.si ? fmt::format(" ({} {})", shown(scene.units.physical(x, dimension)), si) : "";
}

/// What to change when a flow runs away: the collision or the relaxation time if that is close to 1/2, where
/// trt and bgk do not last, else the time step or the drive.
std::string flow_remedy(const Case& scene) {
  constexpr double delicate_relaxation_time = 0.55;
  const double tau = scene.fluid->relaxation_time;
  if (tau < delicate_relaxation_time && !lbm::model_of(scene.fluid->collision).has_eddies())
    return fmt::format(
        "the relaxation time is {}, close to its limit of 0.5: use fluid.collision = \"regularised\", or "
        "raise {}",
        shown(tau),
        scene.units.si ? "fluid.kinematic_viscosity, or use a smaller units.cell_size"
                       : "fluid.relaxation_time");
  return scene.units.si ? "use a smaller units.time_step, or lower what drives the flow"
                        : "lower what drives the flow: velocities, fluid.body_force or gravity.acceleration";
}

}  // namespace

void check_flow(const Case& scene, const FlowTotals& totals, std::int64_t step) {
  const auto stop = [&](const std::string& found) {
    throw CommonGuardStop(fmt::format("step {}: {}; {}", step, found, flow_remedy(scene)));
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

namespace {

/// Of the components of rows [begin, end): infinite or not a number as soon as one is.
double sum_of(const std::vector<rigid::Vec3>& x, std::size_t begin, std::size_t end) {
  return Eigen::Map<const Eigen::VectorXd>(x[begin].data(), 3 * Eigen::Index(end - begin)).sum();
}

struct Speeds {  // squares; the sum is not a number as soon as one is
  double sum = 0, highest = 0;
};
Speeds speeds_of(const rigid::BodySet& bodies, std::size_t begin, std::size_t end) {
  Speeds speeds;
  for (std::size_t row = begin; row < end; ++row) {
    const double square = bodies.velocity[row].squaredNorm();
    speeds.sum += square, speeds.highest = std::max(speeds.highest, square);
  }
  return speeds;
}

/// No row of [begin, end) can have a reason to stop: a few instructions a body, in every step.
bool clearly_sound(const rigid::BodySet& bodies, std::size_t begin, std::size_t end, const Speeds& speeds,
                   double furthest) {
  return std::isfinite(speeds.sum) && speeds.highest <= furthest * furthest &&
         std::isfinite(sum_of(bodies.angular_velocity, begin, end)) &&
         std::isfinite(sum_of(bodies.position, begin, end));
}

std::string speed_remedy(const Case& scene, double too_far, std::int64_t step) {
  if (scene.fluid)
    return fmt::format("use {}a smaller {}",
                       scene.coupling.time == TimeCoupling::explicit_
                           ? "coupling.time = \"implicit\" (light bodies need it) or "
                           : "",
                       scene.units.si ? "units.time_step" : "gravity.acceleration or velocity");
  if (step > 0 && rigid::resolver_model(scene.contacts.resolver).makes_energy) return contact_remedy(scene);
  return fmt::format("beyond that it may pass through others: use contacts.substeps = {:.0f}{}",
                     std::ceil(too_far * scene.contacts.substeps),
                     scene.units.si ? " or a smaller units.time_step" : "");
}

void check_rows(const Case& scene, const MotionLimits& limits, const rigid::BodySet& bodies,
                std::size_t begin, std::size_t end, std::int64_t step, int rank) {
  for (std::size_t row = begin; row < end; ++row) {
    const double speed = bodies.velocity[row].norm(), limit = limits.of(bodies.shape[row]);
    const double sum =
        speed + bodies.angular_velocity[row].squaredNorm() + bodies.position[row].squaredNorm();
    if (!std::isfinite(sum))
      throw GuardStop(fmt::format("step {}: position or velocity of body {} (rank {}) is not a number; {}",
                                  step, bodies.id[row], rank,
                                  scene.fluid ? flow_remedy(scene) : contact_remedy(scene)));
    if (speed > limit)
      throw GuardStop(fmt::format(
          "step {}: body {} (rank {}) moves {} cells in a step{}; at most {} is possible: {}", step,
          bodies.id[row], rank, shown(speed), in_case_units(scene, speed, dimension::velocity, "m/s"),
          shown(limit), speed_remedy(scene, speed / limit, step)));
  }
}

}  // namespace

std::string contact_remedy(const Case& scene) {
  if (rigid::resolver_model(scene.contacts.resolver).makes_energy)
    return fmt::format("contacts.resolver = \"{}\" makes energy where several bodies meet: use \"{}\"",
                       scene.contacts.resolver, rigid::resolver_models().front().name);
  return fmt::format("raise contacts.substeps (now {}){}", scene.contacts.substeps,
                     scene.units.si ? ", or use a smaller units.time_step" : "");
}

double check_motion(const Case& scene, const MotionLimits& limits, const rigid::BodySet& bodies,
                    std::int64_t step, int rank) {
  constexpr std::size_t at_once = 256;
  double highest = 0;
  for (std::size_t begin = 0; begin < bodies.owned; begin += at_once) {
    const std::size_t end = std::min(begin + at_once, bodies.owned);
    const Speeds speeds = speeds_of(bodies, begin, end);
    if (!clearly_sound(bodies, begin, end, speeds, limits.least()))
      check_rows(scene, limits, bodies, begin, end, step, rank);
    highest = std::max(highest, speeds.highest);
  }
  return std::sqrt(highest);
}

std::string overflow_text(const Case& scene, const std::string& what, std::int64_t step,
                          std::optional<int> rank) {
  return fmt::format("step {}: a force on a body is out of range{} ({}); {}", step,
                     rank ? fmt::format(" on rank {}", *rank) : "", what,
                     scene.fluid ? flow_remedy(scene) : contact_remedy(scene));
}

}  // namespace silt::coupler
