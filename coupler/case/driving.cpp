#include "coupler/case/driving.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <numbers>

#include "coupler/case/case.hpp"
#include "coupler/case/case_check.hpp"
#include "coupler/case/case_sections.hpp"
#include "coupler/case/limits.hpp"
#include "rigid/shapes/shape.hpp"

namespace silt::coupler {

namespace {

using rigid::Vec3;

constexpr double endless = std::numeric_limits<double>::infinity();
constexpr double least_exponent = 2.4;  // of Richardson and Zaki, at high Reynolds numbers

/// How far it is from a place to the first side that holds bodies, along a direction.
double way_to_a_side(const Case& scene, const Vec3& x, const Vec3& direction) {
  double way = endless;
  for (int d = 0; d < 3; ++d) {
    const bool up = direction[d] > 0;
    if (scene.periodic(d) || direction[d] == 0) continue;
    way = std::min(way, ((up ? scene.cells[d] : 0) - x[d]) / direction[d]);
  }
  return std::max(0., way);
}

/// Where it is as much as a body weighs.
Vec3 direction_of(const Case& scene, double density) {
  return (density > 1 ? 1 : -1) * scene.gravity.normalized();
}

double speed_of(const Case& scene, const Fall& fall, double gravity) {
  const double steady =
      terminal_velocity(fall.diameter, fall.density, gravity, scene.fluid->kinematic_viscosity);
  const double gain = std::abs(fall.density - 1) / (fall.density + 0.5) * gravity;
  const double on_the_way = std::sqrt(fall.start * fall.start + 2 * gain * fall.height);
  const double in_time = fall.start + gain * static_cast<double>(scene.steps);
  return std::min({fall.hindrance * steady, on_the_way, in_time});
}

double volume_of(const Case& scene, int shape) {
  return rigid::mass_properties(scene.shapes[shape]).volume;
}

double volume_fraction(const Case& scene) {
  double volume = 0;
  for (const Entry& entry : entries_of(scene))
    volume += static_cast<double>(entry.count) * volume_of(scene, entry.shape);
  return std::clamp(volume / (1. * scene.cells[0] * scene.cells[1] * scene.cells[2]), 0., 0.6);
}

/// The corner of a box that has the longest way to go.
Vec3 furthest_corner(const Vec3& lower, const Vec3& upper, const Vec3& direction) {
  Vec3 corner;
  for (int d = 0; d < 3; ++d) corner[d] = direction[d] > 0 ? lower[d] : upper[d];
  return corner;
}

double diameter_of(const Case& scene, int shape) {
  return std::cbrt(6 / std::numbers::pi * volume_of(scene, shape));
}

}  // namespace

std::vector<Fall> expected_falls(const Case& scene) {
  std::vector<Fall> falls;
  if (!scene.fluid || scene.gravity.norm() == 0) return falls;
  const double hindrance = std::pow(1 - volume_fraction(scene), least_exponent);
  scene.for_each_given([&](const BodySpec& body, std::uint64_t) {
    if (body.motion != rigid::Motion::free || body.density == 1) return;
    const std::string entry = entry_key(body.entry);
    if (falls.empty() || falls.back().entry != entry)
      falls.push_back({entry, diameter_of(scene, body.shape), body.density, hindrance});
    const Vec3 down = direction_of(scene, body.density);
    const double height = body.point > 0 ? endless : way_to_a_side(scene, body.pose.position, down);
    falls.back().start = std::max(falls.back().start, body.velocity.norm());
    falls.back().height = std::max(falls.back().height, height);
  });
  for (std::size_t i = 0; i < scene.fills.size(); ++i) {
    const FillSpec& fill = scene.fills[i];
    if (fill.density == 1) continue;
    const Vec3 down = direction_of(scene, fill.density);
    const double height = way_to_a_side(scene, furthest_corner(fill.lower, fill.upper, down), down);
    falls.push_back({fmt::format("fill[{}]", i), diameter_of(scene, fill.shape), fill.density, hindrance,
                     fill.velocity.norm(), height});
  }
  for (Fall& fall : falls) fall.speed = speed_of(scene, fall, scene.gravity.norm());
  return falls;
}

double gravity_share(const Case& scene, const Fall& fall, double speed) {
  double low = 0, high = 1;
  for (int i = 0; i < 60; ++i) {
    const double middle = (low + high) / 2;
    (speed_of(scene, fall, middle * scene.gravity.norm()) > speed ? high : low) = middle;
  }
  return low;
}

double terminal_velocity(double diameter, double density, double gravity, double nu) {
  const double buoyancy = 4. / 3 * std::abs(density - 1) * gravity * diameter;  // u^2 C_D
  const auto drag = [&](double u) {
    const double reynolds = u * diameter / nu;
    return 24 * nu / diameter * u * (1 + 0.15 * std::pow(reynolds, 0.687));
  };
  double low = 0, high = buoyancy * diameter / (24 * nu);  // Stokes: an upper bound
  for (int i = 0; i < 100; ++i) {
    const double middle = (low + high) / 2;
    (drag(middle) < buoyancy ? low : high) = middle;
  }
  return low;
}

namespace {

using rigid::Motion;
using rigid::Vec3;

constexpr double most_body_force = 0.1, most_gravity = 1;  // cells a step, gained in a step
constexpr double most_metres = 500;                        // m/s2: of gravity, but in a centrifuge

void check_gain(const Case& scene, Findings& findings, const char* key, double gained, double most) {
  if (!(gained > most)) return;
  const std::string cure = time_step_cure(scene, std::sqrt(most / gained));
  findings.error(
      key, "{} adds {} cells a step to a velocity in every step; at most {} is possible: {}or lower it to {}",
      key, shown(gained), shown(most), cure.empty() ? "shorten the time step, " : cure + ", ",
      shown(scene.units.physical(most, dimension::acceleration)));
}

void check_metres(const Case& scene, Findings& findings) {
  const double gravity = scene.units.physical(scene.gravity.norm(), dimension::acceleration);
  if (scene.units.si && gravity > most_metres)
    findings.warning("gravity.acceleration",
                     "gravity.acceleration is {} m/s2; that of the Earth is 9.81, which is 9810 mm/s2",
                     shown(gravity));
}

bool all_periodic(const Case& scene) {
  return scene.periodic(0) && scene.periodic(1) && scene.periodic(2) && scene.walls.empty();
}

void check_endless_fall(const Case& scene, Findings& findings) {
  const bool held = scene.any_given([](const BodySpec& b) { return b.motion != Motion::free; });
  const bool balanced = scene.fluid && scene.fluid->body_force != Vec3::Zero();
  if (scene.has_bodies() && scene.gravity.norm() > 0 && all_periodic(scene) && !held && !balanced)
    findings.warning("gravity.acceleration",
                     "gravity acts, but nothing holds the fluid and the bodies: a domain that is periodic "
                     "all round accelerates for ever; fluid.body_force can balance their weight");
}

/// Whether anything moves at the start, is moved or is driven.
bool anything_drives(const Case& scene) {
  const FluidSpec& fluid = *scene.fluid;
  const std::vector<Entry> entries = entries_of(scene);
  return scene.gravity.norm() > 0 || fluid.body_force.norm() > 0 || fluid.initial.largest_speed() > 0 ||
         fluid.initial.noise > 0 || std::any_of(entries.begin(), entries.end(), std::mem_fn(&Entry::moves)) ||
         std::any_of(
             scene.boundary.begin(), scene.boundary.end(),
             [](const BoundarySpec& side) { return side.velocity.norm() > 0 || side.density != 1; }) ||
         std::any_of(scene.walls.begin(), scene.walls.end(), std::mem_fn(&CurvedWall::moves));
}

void check_weight(const Case& scene, Findings& findings) {
  if (scene.places.count("gravity.acceleration") || anything_drives(scene)) return;
  const std::vector<Entry> entries = entries_of(scene);
  const auto heavy = std::find_if(entries.begin(), entries.end(),
                                  [](const Entry& entry) { return entry.is_free() && entry.density != 1; });
  if (heavy != entries.end())
    findings.warning(heavy->key + ".density",
                     "{} is heavier or lighter than the fluid, but there is no [gravity] and nothing else "
                     "moves: all stays at rest; give gravity.acceleration = [0, 0, {}]",
                     heavy->key, scene.units.si ? "-9.81" : "-1e-4");
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
    findings.error(key, "{}; at most {} is possible: {}", found, impossible_velocity, cure);
  else
    findings.warning(key, "{}; above {} the fluid is noticeably compressible: {}", found, doubtful_velocity,
                     cure);
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
    if (const rigid::HollowWallSpec* hollow = wall.hollow())
      speed = std::min(speed, force.norm() * hollow->shape.widest() * hollow->shape.widest() / (4 * nu));
  return speed;
}

void check_flow(const Case& scene, Findings& findings) {
  const auto meshes = [](const CurvedWall& wall) { return wall.mesh() != nullptr; };
  if (scene.has_bodies() || std::any_of(scene.walls.begin(), scene.walls.end(), meshes)) return;
  const double speed = laminar_speed(scene);
  if (!(speed > doubtful_velocity)) return;
  const double factor = doubtful_velocity / speed;
  findings.warning("fluid.body_force",
                   "fluid.body_force drives laminar flow at up to {} cells a step{}; above {} the fluid is "
                   "noticeably compressible: {}",
                   shown(speed), in_metres_a_second(scene, speed), doubtful_velocity,
                   scene.units.si ? time_step_cure(scene, factor)
                                  : fmt::format("use {} times as much", shown(rounded_down(factor))));
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
