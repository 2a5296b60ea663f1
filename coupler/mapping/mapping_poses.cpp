#include "coupler/mapping/mapping_poses.hpp"

#include <algorithm>
#include <cmath>

#include "coupler/exchange/coupling_state.hpp"
#include "rigid/math/types.hpp"
#include "rigid/shapes/shape.hpp"

namespace silt::coupler {

using rigid::Pose;
using rigid::Quat;
using rigid::Vec3;

namespace {

constexpr double rounding = 1e-9;    // relative, for ways of whole numbers of steps
constexpr double held_share = 0.15;  // of the tolerance, where distances are not updated
constexpr double unforeseen =
    1.1;  // of the tolerance: a body that speeds up may leave its foreseen place so far

/// Most steps between mappings of a body whose distances are updated: a slower body will soon be at rest, and
/// is mapped at its present pose.
constexpr double most_following = 81;

/// Returns the largest power of three that does not exceed `most`.
std::int64_t power_of_three(double most) {
  std::int64_t power = 1;
  while (3 * static_cast<double>(power) <= most) power *= 3;
  return power;
}

/// Returns the number of steps at this speed whose ends are within the tolerance of their middle.
double steps_within(double tolerance, double speed) {
  constexpr double most = 1e6;
  return speed * most <= 2 * tolerance ? most : std::floor((1 + rounding) * 2 * tolerance / speed);
}

/// Returns the angle: |q - q'| of two unit quaternions, or |q + q'|, is half of it.
double angle_between(const Quat& a, const Quat& b) {
  return 2 * std::min((a.coeffs() - b.coeffs()).norm(), (a.coeffs() + b.coeffs()).norm());
}

/// Moves the pose to the middle of the steps that it serves.
MappedMotion mapped_ahead(MappedMotion m) {
  m.set_pose(m.pose_after(m.middle() - static_cast<double>(m.steps.first)));
  return m;
}

}  // namespace

void renew_mapping_poses(rigid::BodySet& bodies, const rigid::World& world, const rigid::Extent& extent,
                         const CouplingSpec& coupling, std::int64_t step) {
  const double held = held_share * coupling.remap_tolerance;
  const bool links_follow = lbm::follows_distance(coupling.wall_scheme);
  for (std::size_t row = 0; row < bodies.first_wall(); ++row) {
    const rigid::Shape& shape = world.shapes[bodies.shape[row]];
    // rotation does not change a ball
    const bool is_ball = std::holds_alternative<rigid::Sphere>(shape);
    const double radius = is_ball ? 0 : world.bounding_radii[bodies.shape[row]];
    const Vec3 v = bodies.velocity[row], w = is_ball ? Vec3(0, 0, 0) : bodies.angular_velocity[row];
    MappedMotion& mapped = coupling_of(bodies, row).mapped;
    const Pose now{bodies.position[row], is_ball ? mapped.pose().orientation : bodies.orientation[row]};
    const Pose foreseen = mapped.pose_after(static_cast<double>(step) - mapped.middle());
    const double off = nearest_image(now.position - foreseen.position, extent).norm() +
                       radius * angle_between(now.orientation, foreseen.orientation);
    if (2 * off <= held && mapped.is_at_rest()) continue;
    if (step < mapped.steps.end && off <= unforeseen * held) continue;
    const double speed = v.norm() + radius * w.norm();
    double steps = 1 + steps_within(held, speed);
    const bool follows =
        links_follow && steps < most_following && !std::holds_alternative<rigid::Mesh>(shape);
    if (follows) steps = std::min(1 + steps_within(coupling.remap_tolerance, speed), most_following);
    const std::int64_t interval = power_of_three(steps);
    MappedMotion next = mapped_ahead({now, v, w, step, step + interval - step % interval});
    if (!follows) next.velocity = {};
    mapped = next;
  }
}

WallMapping::WallMapping(const rigid::MeshWallSpec& wall, double tolerance) : wall_(wall) {
  const double speed = wall.motion.speed_bound(wall.reach());
  const auto most = static_cast<std::int64_t>(steps_within(held_share * tolerance, speed));
  steps_ = 1 + most - most % 2;  // odd
}

Pose WallMapping::pose(std::int64_t step) const {
  const auto first = static_cast<double>(step - step % steps_);
  return wall_.pose(first + 0.5 * static_cast<double>(steps_ - 1));
}

}  // namespace silt::coupler
