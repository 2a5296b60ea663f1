#include "coupler/case/driving_check.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>

#include "coupler/case/body_text.hpp"
#include "coupler/case/case.hpp"
#include "coupler/case/expected_fall.hpp"
#include "coupler/case/speed_check.hpp"
#include "coupler/case/time_step_cure.hpp"

namespace silt::coupler {
namespace {

using rigid::Motion;
using rigid::Vec3;

constexpr double most_body_force = 0.1, most_gravity = 1;  // cells a step, gained in a step
constexpr double most_metres = 500;                        // m/s2: of gravity, but in a centrifuge

void check_gain(const Case& scene, Findings& findings, const char* key, double gained, double most) {
  if (!(gained > most)) return;
  const std::string cure = time_step_cure(scene, std::sqrt(most / gained));
  findings.error(
      key,
      fmt::format("{} adds {} cells a step to a velocity in every step; at most {} is possible: {}or "
                  "lower it to {}",
                  key, shown(gained), shown(most), cure.empty() ? "shorten the time step, " : cure + ", ",
                  shown(scene.units.physical(most, dimension::acceleration))));
}

void check_metres(const Case& scene, Findings& findings) {
  const double gravity = scene.units.physical(scene.gravity.norm(), dimension::acceleration);
  if (scene.units.si && gravity > most_metres)
    findings.warning("gravity.acceleration",
                     fmt::format("gravity.acceleration is {} m/s2; that of the Earth is 9.81, which is 9810 "
                                 "mm/s2",
                                 shown(gravity)));
}

bool all_periodic(const Case& scene) {
  return scene.periodic(0) && scene.periodic(1) && scene.periodic(2) && scene.walls.empty();
}

void check_endless_fall(const Case& scene, Findings& findings) {
  const bool held = scene.any_given([](const BodySpec& b) { return b.motion != Motion::free; });
  const bool balanced = scene.fluid && scene.fluid->body_force != Vec3::Zero();
  if (scene.has_bodies() && scene.gravity.norm() > 0 && all_periodic(scene) && !held && !balanced)
    findings.warning("gravity.acceleration",
                     "gravity acts, but nothing holds the fluid and the bodies: a domain that is "
                     "periodic all round accelerates for ever; fluid.body_force can balance their weight");
}

/// Whether anything moves at the start, is moved or is driven.
bool anything_drives(const Case& scene) {
  const auto moves = [](const BodySpec& b) { return b.velocity.norm() + b.angular_velocity.norm() > 0; };
  const FluidSpec& fluid = *scene.fluid;
  return scene.gravity.norm() > 0 || fluid.body_force.norm() > 0 || fluid.initial.largest_speed() > 0 ||
         fluid.initial.noise > 0 || scene.any_given(moves) ||
         std::any_of(scene.fills.begin(), scene.fills.end(),
                     [](const FillSpec& fill) { return fill.velocity.norm() > 0; }) ||
         std::any_of(
             scene.boundary.begin(), scene.boundary.end(),
             [](const BoundarySpec& side) { return side.velocity.norm() > 0 || side.density != 1; }) ||
         std::any_of(scene.walls.begin(), scene.walls.end(), std::mem_fn(&CurvedWall::moves));
}

/// The entry of the first free bodies that are heavier or lighter than the fluid, or "".
std::string entry_with_weight(const Case& scene) {
  std::string entry;
  scene.for_each_given([&](const BodySpec& body, std::uint64_t) {
    if (entry.empty() && body.motion == Motion::free && body.density != 1) entry = entry_key(body.entry);
  });
  for (std::size_t i = 0; i < scene.fills.size() && entry.empty(); ++i)
    if (scene.fills[i].density != 1) entry = fmt::format("fill[{}]", i);
  return entry;
}

void check_weight(const Case& scene, Findings& findings) {
  if (scene.places.count("gravity.acceleration") || anything_drives(scene)) return;
  if (const std::string entry = entry_with_weight(scene); !entry.empty())
    findings.warning(entry + ".density",
                     fmt::format("{} is heavier or lighter than the fluid, but there is no [gravity] and "
                                 "nothing else moves: all stays at rest; give gravity.acceleration = "
                                 "[0, 0, {}]",
                                 entry, scene.units.si ? "-9.81" : "-1e-4"));
}

/// What makes a fall slow enough: shorter steps, or (in lattice units) less gravity.
std::string fall_cure(const Case& scene, const Fall& fall) {
  if (scene.units.si) return time_step_cure(scene, doubtful_velocity / fall.speed);
  return fmt::format("use {} times as much gravity.acceleration",
                     shown(rounded_down(gravity_share(scene, fall, doubtful_velocity))));
}

void check_fall(const Case& scene, Findings& findings, const Fall& fall) {
  if (!(fall.speed > doubtful_velocity)) return;
  const std::string found = fmt::format("{} comes to {} cells a step{} as it {} (a sphere of its volume)",
                                        fall.entry, shown(fall.speed), in_metres_a_second(scene, fall.speed),
                                        fall.density > 1 ? "falls" : "rises");
  const std::string key = fall.entry + ".density", cure = fall_cure(scene, fall);
  if (fall.speed > impossible_velocity)
    findings.error(key, fmt::format("{}; at most {} is possible: {}", found, impossible_velocity, cure));
  else
    findings.warning(key, fmt::format("{}; above {} the fluid is noticeably compressible: {}", found,
                                      doubtful_velocity, cure));
}

/// The largest velocity of laminar flow under the body force, between walls across it or, where there are
/// none, at the end; lattice units.
double laminar_speed(const Case& scene) {
  const Vec3& force = scene.fluid->body_force;
  const double nu = scene.fluid->kinematic_viscosity;
  double speed = force.norm() * static_cast<double>(scene.steps);
  for (int d = 0; d < 3; ++d) {
    if (scene.periodic(d)) continue;
    Vec3 along = force;
    along[d] = 0;
    speed = std::min(speed, along.norm() * scene.cells[d] * scene.cells[d] / (8 * nu));
  }
  for (const CurvedWall& wall : scene.walls)
    if (const rigid::TubeSpec* tube = wall.tube())
      speed = std::min(speed, force.norm() * tube->radius * tube->radius / (4 * nu));
  return speed;
}

void check_flow(const Case& scene, Findings& findings) {
  const auto meshes = [](const CurvedWall& wall) { return wall.mesh() != nullptr; };
  if (scene.has_bodies() || std::any_of(scene.walls.begin(), scene.walls.end(), meshes)) return;
  const double speed = laminar_speed(scene);
  if (!(speed > doubtful_velocity)) return;
  const double factor = doubtful_velocity / speed;
  findings.warning(
      "fluid.body_force",
      fmt::format("fluid.body_force drives laminar flow at up to {} cells a step{}; above {} the fluid is "
                  "noticeably compressible: {}",
                  shown(speed), in_metres_a_second(scene, speed), doubtful_velocity,
                  scene.units.si ? time_step_cure(scene, factor)
                                 : fmt::format("use {} times as much", shown(rounded_down(factor)))));
}

}  // namespace

void find_driving_faults(const Case& scene, Findings& findings) {
  check_gain(scene, findings, "gravity.acceleration", scene.gravity.cwiseAbs().maxCoeff(), most_gravity);
  check_metres(scene, findings);
  check_endless_fall(scene, findings);
  if (!scene.fluid) return;
  check_gain(scene, findings, "fluid.body_force", scene.fluid->body_force.cwiseAbs().maxCoeff(),
             most_body_force);
  check_weight(scene, findings);
  check_flow(scene, findings);
  for (const Fall& fall : expected_falls(scene)) check_fall(scene, findings, fall);
}

}  // namespace silt::coupler
