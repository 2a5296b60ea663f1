#include "coupler/mapping/mapping_poses.hpp"

#include <algorithm>
#include <bit>
#include <cmath>

#include "coupler/exchange/coupling_state.hpp"
#include "rigid/math/twist.hpp"
#include "rigid/shapes/shape.hpp"

namespace silt::coupler {

using rigid::Pose;
using rigid::Quat;
using rigid::Vec3;

namespace {

constexpr double rounding = 1e-9;   // relative: of a way of so many whole steps
constexpr double unforeseen = 1.1;  // times the tolerance: as far as what speeds up on its way may get

/// Steps on whose way nothing as fast as that is further than the tolerance from the middle.
double steps_within(double tolerance, double speed) {
  constexpr double most = 1e6;
  return speed * most <= 2 * tolerance ? most : std::floor((1 + rounding) * 2 * tolerance / speed);
}

/// |q - q'| of two unit quaternions is half the angle between them, or that of q and -q'.
double angle_between(const Quat& a, const Quat& b) {
  return 2 * std::min((a.coeffs() - b.coeffs()).norm(), (a.coeffs() + b.coeffs()).norm());
}

}  // namespace

void renew_mapping_poses(rigid::BodySet& bodies, const rigid::World& world, double tolerance,
                         std::int64_t step) {
  for (std::size_t row = 0; row < bodies.first_wall(); ++row) {
    const Pose now = bodies.pose(row), mapped = mapping_pose(bodies, row);
    if (now == mapped) continue;
    // a ball looks the same however it has turned
    const bool is_ball = std::holds_alternative<rigid::Sphere>(world.shapes[bodies.shape[row]]);
    const double radius = is_ball ? 0 : world.bounding_radii[bodies.shape[row]];
    const double moved =
        (now.position - mapped.position).norm() + radius * angle_between(now.orientation, mapped.orientation);
    if (2 * moved <= tolerance) continue;
    const Vec3 v = bodies.velocity[row], w = is_ball ? Vec3(0, 0, 0) : bodies.angular_velocity[row];
    const double steps = 1 + steps_within(tolerance, v.norm() + radius * w.norm());
    const auto interval = static_cast<std::int64_t>(std::bit_floor(static_cast<std::uint64_t>(steps)));
    const std::int64_t left = interval - step % interval;  // whole at the step that is the interval's first
    if (left < interval && moved <= unforeseen * tolerance) continue;
    const double ahead = 0.5 * static_cast<double>(left - 1);
    set_mapping_pose(bodies, row, {now.position + ahead * v, rigid::cayley(ahead * w) * now.orientation});
  }
}

WallMapping::WallMapping(const rigid::MeshWallSpec& wall, double tolerance) : wall_(wall) {
  const double speed = wall.motion.speed_bound(wall.mesh.surface->radius());
  steps_ = 1 + static_cast<std::int64_t>(steps_within(tolerance, speed));
}

Pose WallMapping::pose(std::int64_t step) const {
  const auto first = static_cast<double>(step - step % steps_);
  return wall_.motion.pose(wall_.start, first + 0.5 * static_cast<double>(steps_ - 1));
}

}  // namespace silt::coupler
