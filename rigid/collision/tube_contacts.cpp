#include "rigid/collision/tube_contacts.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>

#include "rigid/math/elementary.hpp"
#include "rigid/shapes/shape.hpp"

namespace silt::rigid {
namespace {

using Vec2 = Eigen::Vector2d;

/// A tube in its own cross-section: x and y of its frame, relative to the axis.
class PlacedTube {
 public:
  PlacedTube(const Tube& tube, const Pose& pose)
      : radius_(tube.radius), position_(pose.position), turn_(pose.orientation.toRotationMatrix()) {}
  Vec2 of_point(const Vec3& x_W) const { return of_direction(x_W - position_); }
  Vec2 of_direction(const Vec3& v_W) const { return {turn_.col(0).dot(v_W), turn_.col(1).dot(v_W)}; }
  Vec3 to_world(const Vec2& v) const { return v[0] * turn_.col(0) + v[1] * turn_.col(1); }
  double gap(const Vec3& x) const { return radius_ - of_point(x).norm(); }
  Vec3 outward(const Vec3& x) const {
    const Vec2 from_axis = of_point(x);
    const double distance = from_axis.norm();
    return to_world(distance > 0 ? Vec2(from_axis / distance) : Vec2(Vec2::UnitX()));
  }

 private:
  double radius_;
  const Vec3& position_;
  Mat3 turn_;
};

/// The local maxima of the distance from the origin on an ellipse: unit directions from the origin to those
/// points, the furthest first, and at which end of the major axis each is (0 or 1, constant over steps while
/// the ellipse rotates by less than half a turn). A circle about the origin has one, along the first axis.
struct FurthestOnEllipse {
  std::array<Vec2, 2> direction;
  std::array<int, 2> end{};
  int count = 1;
};

/// Finds by bisection the zero of `slope`, which is positive before and negative after it.
template <class Slope>
double crossing(double low, double high, Slope&& slope) {
  constexpr int halvings = 55;  // reduces a quarter of a turn to rounding
  for (int i = 0; i < halvings; ++i) {
    const double middle = 0.5 * (low + high);
    (slope(middle) > 0 ? low : high) = middle;
  }
  return 0.5 * (low + high);
}

/// The ellipse is centre + u cos t + v sin t, given by spread = u u^T + v v^T.
///
/// In the frame of its half axes a >= b, with the centre (p, q) in the first quadrant, the derivative of the
/// squared distance is 2 sin t cos t (-p a / cos t + q b / sin t - k), k = a^2 - b^2. In the first quadrant
/// the bracket decreases, so there is one maximum. In the second, with t = pi - s, the derivative by s is 2
/// sin s cos s (p a / cos s + q b / sin s - k), whose bracket has one minimum, at tan^3 s = q b / (p a): if
/// that is negative there is a second maximum, at the zero before it.
FurthestOnEllipse furthest_on_ellipse(const Vec2& centre, const Eigen::Matrix2d& spread) {
  const double mean = 0.5 * (spread(0, 0) + spread(1, 1)), half = 0.5 * (spread(0, 0) - spread(1, 1));
  const double k = 2 * elementary::hypot(half, spread(0, 1));  // a^2 - b^2
  const double turn = 0.5 * elementary::atan2(spread(0, 1), half);
  Vec2 along(elementary::cos(turn), elementary::sin(turn)), across(-along[1], along[0]);
  const int near_end = along.dot(centre) < 0;
  if (near_end) along = -along;
  if (across.dot(centre) < 0) across = -across;
  const double p = along.dot(centre), q = across.dot(centre);
  const double a = std::sqrt(mean + 0.5 * k), b = std::sqrt(std::max(0.0, mean - 0.5 * k));
  const double pa = p * a, qb = q * b;
  const auto direction = [&](double t) -> Vec2 {
    const Vec2 x = (p + a * elementary::cos(t)) * along + (q + b * elementary::sin(t)) * across;
    const double length = x.norm();
    return length > 0 ? Vec2(x / length) : along;
  };

  constexpr double quarter = 0.5 * std::numbers::pi;
  FurthestOnEllipse found;
  found.end = {near_end, 1 - near_end};
  found.direction[0] = direction(crossing(0, quarter, [&](double t) {
    const double s = elementary::sin(t), c = elementary::cos(t);
    return qb * c - pa * s - k * s * c;
  }));
  const double least = elementary::atan2(elementary::cbrt(qb), elementary::cbrt(pa));
  const double sum = elementary::cbrt(pa * pa) + elementary::cbrt(qb * qb);
  if (sum * std::sqrt(sum) < k) {
    const double t = std::numbers::pi - crossing(0, least, [&](double s) {
                       return pa * elementary::sin(s) + qb * elementary::cos(s) -
                              k * elementary::sin(s) * elementary::cos(s);
                     });
    found.direction[1] = direction(t);
    found.count = 2;
  }
  return found;
}

/// Calls use(centre, radius, feature) for balls or points of a body, including the one nearest to the wall:
/// from the balls, discs and ellipsoids of whose union the body is the convex hull (`extremes` of its shape).
template <class Use>
class ExtremePoints {
 public:
  ExtremePoints(const Pose& body, const PlacedTube& wall, const Use& use)
      : pose_(body), wall_(wall), use_(use) {}

  void ball(const Vec3& centre_B, double radius, std::uint32_t feature) const {
    use_(pose_.to_world(centre_B), radius, feature);
  }
  /// Handles a disc about the body's z axis at height z.
  void disc(double z, double radius, std::uint32_t first_feature) const {
    const Mat3 turn = pose_.orientation.toRotationMatrix();
    const Vec3 centre = pose_.to_world({0, 0, z});
    const Vec2 u = radius * wall_.of_direction(turn.col(0)), v = radius * wall_.of_direction(turn.col(1));
    for_nearest(centre, u * u.transpose() + v * v.transpose(), first_feature, [&](const Vec3& n) -> Vec3 {
      const double x = turn.col(0).dot(n), y = turn.col(1).dot(n), across = elementary::hypot(x, y);
      if (!(across > 0)) return centre;  // the whole rim is at equal distance
      return centre + radius / across * (x * turn.col(0) + y * turn.col(1));
    });
  }
  void ellipsoid(const Vec3& half_axes, std::uint32_t first_feature) const {
    const Mat3 axes = pose_.orientation.toRotationMatrix() * half_axes.asDiagonal();
    Eigen::Matrix<double, 2, 3> shadow;
    for (int k = 0; k < 3; ++k) shadow.col(k) = wall_.of_direction(axes.col(k));
    for_nearest(pose_.position, shadow * shadow.transpose(), first_feature, [&](const Vec3& n) -> Vec3 {
      return pose_.position + axes * (axes.transpose() * n).normalized();
    });
  }

 private:
  /// support(n): the point of a disc or ellipsoid furthest along n. Its projection along the tube's axis is
  /// an ellipse of this spread; n points from the axis to its furthest point.
  template <class Support>
  void for_nearest(const Vec3& centre, const Eigen::Matrix2d& spread, std::uint32_t first_feature,
                   Support&& support) const {
    const FurthestOnEllipse found = furthest_on_ellipse(wall_.of_point(centre), spread);
    const bool ordered = found.count < 2 || found.end[0] == 0;
    for (int k = 0; k < found.count; ++k) {
      const int which = ordered ? k : 1 - k;
      use_(support(wall_.to_world(found.direction[which])), 0, first_feature + found.end[which]);
    }
  }

  const Pose& pose_;
  const PlacedTube& wall_;
  const Use& use_;
};

template <class Use>
void for_extreme_points(const ConvexShape& body, const Pose& pose, const PlacedTube& wall, Use&& use) {
  const ExtremePoints points(pose, wall, use);
  std::visit([&](const auto& shape) { shape.extremes(points); }, body);
}

}  // namespace

void append_tube_contacts(const ConvexShape& body, const Pose& pose, const Tube& tube,
                          const Pose& pose_of_tube, double tolerance, std::vector<ContactPoint>& out) {
  const PlacedTube wall(tube, pose_of_tube);
  for_extreme_points(body, pose, wall, [&](const Vec3& centre, double radius, std::uint32_t feature) {
    const double gap = wall.gap(centre) - radius;
    if (gap > tolerance) return;
    const Vec3 normal = wall.outward(centre), on_body = centre + radius * normal;
    out.push_back({on_body, on_body + gap * normal, normal, gap, feature});
  });
}

double gap_in_tube(const Shape& shape, const Pose& pose, const Tube& tube, const Pose& pose_of_tube) {
  const PlacedTube wall(tube, pose_of_tube);
  double gap = std::numeric_limits<double>::infinity();
  for (const Part& part : convex_parts(shape))
    for_extreme_points(part.shape, pose * part.pose, wall,
                       [&](const Vec3& centre, double radius, std::uint32_t) {
                         gap = std::min(gap, wall.gap(centre) - radius);
                       });
  return gap;
}

}  // namespace silt::rigid
