#pragma once
// The points of an ellipse in the plane that are further from the origin than those near them.
#include <Eigen/Dense>
#include <array>

namespace silt::rigid {

/// Unit directions from the origin to those points, the one further from the origin first, and at which end
/// of the longer axis each is (0 or 1; the same end from step to step while the ellipse turns less than half
/// a turn). On a circle about the origin: one, along the first axis.
struct FurthestOnEllipse {
  std::array<Eigen::Vector2d, 2> direction;
  std::array<int, 2> end{};
  int count = 1;
};

/// The ellipse is centre + u cos t + v sin t, given by spread = u u^T + v v^T.
///
/// In the frame of its half axes a >= b, with the centre (p, q) in the first quadrant, the distance's square
/// has the slope  2 sin t cos t (-p a / cos t + q b / sin t - k),  k = a^2 - b^2.  In the first quadrant the
/// bracket falls, so there is one furthest point in it; in the second one, where t = pi - s, the slope by s
/// is 2 sin s cos s (p a / cos s + q b / sin s - k), a bracket with one minimum, at tan^3 s = q b / (p a):
/// below 0 there is a second furthest point, at the bracket's zero before it.
FurthestOnEllipse furthest_on_ellipse(const Eigen::Vector2d& centre, const Eigen::Matrix2d& spread);

}  // namespace silt::rigid
