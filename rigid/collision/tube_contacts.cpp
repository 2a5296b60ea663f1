#include "rigid/collision/tube_contacts.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "rigid/math/elementary.hpp"
#include "rigid/shapes/furthest_on_ellipse.hpp"
#include "rigid/shapes/shape.hpp"

namespace silt::rigid {

namespace {

using Vec2 = Eigen::Vector2d;

/// Seen along the axis of the tube: x and y of its frame, from the axis.
class CrossSection {
 public:
  explicit CrossSection(const Pose& tube) : pose_(tube), turn_(tube.orientation.toRotationMatrix()) {}
  Vec2 of_point(const Vec3& x_W) const { return of_direction(x_W - pose_.position); }
  Vec2 of_direction(const Vec3& v_W) const { return {turn_.col(0).dot(v_W), turn_.col(1).dot(v_W)}; }
  Vec3 to_world(const Vec2& v) const { return v[0] * turn_.col(0) + v[1] * turn_.col(1); }
  Vec3 axis() const { return turn_.col(2); }

 private:
  const Pose& pose_;
  Mat3 turn_;
};

/// Calls use(centre, radius, feature) for balls or points of a body, the furthest from the axis among them.
/// The body says which balls, discs and ellipsoids it is the hull of (`extremes`); one that does not is
/// searched.
template <class Use>
class ExtremePoints {
 public:
  ExtremePoints(const Pose& body, const CrossSection& section, Use& use)
      : pose_(body), section_(section), use_(use) {}

  template <class S>
  void operator()(const S& shape) const {
    if constexpr (requires { shape.extremes(*this); })
      shape.extremes(*this);
    else
      search(shape);
  }

  void ball(const Vec3& centre_B, double radius, std::uint32_t feature) const {
    use_(pose_.to_world(centre_B), radius, feature);
  }
  /// About the body's z axis, at this z. Its rim is an ellipse in the cross-section.
  void disc(double z, double radius, std::uint32_t first_feature) const {
    const Mat3 turn = pose_.orientation.toRotationMatrix();
    const Vec2 u = radius * section_.of_direction(turn.col(0)),
               v = radius * section_.of_direction(turn.col(1));
    const Eigen::Matrix2d spread = u * u.transpose() + v * v.transpose();
    const Vec3 centre = pose_.to_world({0, 0, z});
    for_furthest(centre, spread, first_feature, [&](const Vec3& n) -> Vec3 {
      const double x = turn.col(0).dot(n), y = turn.col(1).dot(n), across = elementary::hypot(x, y);
      if (!(across > 0)) return centre;  // the whole rim is equally far
      return centre + radius / across * (x * turn.col(0) + y * turn.col(1));
    });
  }
  /// Its shadow along the axis is an ellipse too.
  void ellipsoid(const Vec3& half_axes, std::uint32_t first_feature) const {
    const Mat3 axes = pose_.orientation.toRotationMatrix() * half_axes.asDiagonal();
    Eigen::Matrix<double, 2, 3> shadow;
    for (int k = 0; k < 3; ++k) shadow.col(k) = section_.of_direction(axes.col(k));
    for_furthest(pose_.position, shadow * shadow.transpose(), first_feature, [&](const Vec3& n) -> Vec3 {
      return pose_.position + axes * (axes.transpose() * n).normalized();
    });
  }

 private:
  /// support(n): the point of the body on that ellipse furthest along n; where it is furthest from the axis,
  /// n points from the axis to it.
  template <class Support>
  void for_furthest(const Vec3& centre, const Eigen::Matrix2d& spread, std::uint32_t first_feature,
                    Support&& support) const {
    const FurthestOnEllipse found = furthest_on_ellipse(section_.of_point(centre), spread);
    const bool ordered = found.count < 2 || found.end[0] == 0;
    for (int k = 0; k < found.count; ++k) {
      const int which = ordered ? k : 1 - k;
      use_(support(section_.to_world(found.direction[which])), 0, first_feature + found.end[which]);
    }
  }

  /// From directions all round: the point furthest along the way from the axis to the last one is further
  /// still.
  template <class S>
  void search(const S& shape) const {
    constexpr int directions = 8, steps = 100;
    const Mat3 turn = pose_.orientation.toRotationMatrix();
    for (int k = 0; k < directions; ++k) {
      const double angle = 2 * std::numbers::pi * k / directions;
      Vec2 n(elementary::cos(angle), elementary::sin(angle));
      Vec3 x = pose_.position;
      for (int step = 0; step < steps; ++step) {
        x = pose_.position + turn * shape.support(turn.transpose() * section_.to_world(n));
        const Vec2 next = section_.of_point(x).normalized();
        if (!(section_.of_point(x).norm() > 0) || next == n) break;
        n = next;
      }
      use_(x, 0, k);
    }
  }

  const Pose& pose_;
  const CrossSection& section_;
  Use& use_;
};

template <class Use>
void for_extreme_points(const ConvexShape& body, const Pose& pose, const CrossSection& section, Use&& use) {
  std::visit(ExtremePoints(pose, section, use), body);
}

}  // namespace

void append_tube_contacts(const ConvexShape& body, const Pose& pose, const Tube& tube,
                          const Pose& pose_of_tube, double tolerance, std::vector<ContactPoint>& out) {
  const CrossSection section(pose_of_tube);
  for_extreme_points(body, pose, section, [&](const Vec3& centre, double radius, std::uint32_t feature) {
    const Vec2 from_axis = section.of_point(centre);
    const double distance = from_axis.norm(), gap = tube.radius - distance - radius;
    if (gap > tolerance) return;
    const Vec3 normal = section.to_world(distance > 0 ? Vec2(from_axis / distance) : Vec2(Vec2::UnitX()));
    const Vec3 on_body = centre + radius * normal;
    out.push_back({on_body, on_body + gap * normal, normal, gap, feature});
  });
}

double gap_in_tube(const Shape& shape, const Pose& pose, const Tube& tube, const Pose& pose_of_tube) {
  const CrossSection section(pose_of_tube);
  double gap = std::numeric_limits<double>::infinity();
  for (const Part& part : convex_parts(shape))
    for_extreme_points(part.shape, pose * part.pose, section,
                       [&](const Vec3& centre, double radius, std::uint32_t) {
                         gap = std::min(gap, tube.radius - section.of_point(centre).norm() - radius);
                       });
  return gap;
}

}  // namespace silt::rigid
