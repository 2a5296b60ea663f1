#pragma once
#include <stdexcept>

#include "rigid/shapes/solid.hpp"

namespace silt::rigid {

/// All points at least `radius` from the body's z axis, without end: a wall round about what is inside. Only
/// for walls: infinite mass, not convex, so no collision backend sees it (rigid/collision/tube_contacts.hpp).
struct Tube {
  static constexpr std::string_view name = "tube";
  double radius;
  static constexpr auto fields = std::tuple{radius_field(&Tube::radius)};

  double signed_distance(const Vec3& x) const { return radius - std::sqrt(x[0] * x[0] + x[1] * x[1]); }
  /// The part of the line that is in the hollow, in closed form; none if it is all in the wall.
  std::optional<LineInterval> hollow_interval(const Vec3& o, const Vec3& d) const;
  double ray_distance(const Vec3& o, const Vec3& d, double t_max) const;
  BoundingBox bounding_box(const Pose&) const { return BoundingBox::everything(); }
  /// As that of a convex shape (convex_shape.hpp), where its outward normal, towards the axis, is n_B:
  /// hollow, so negative.
  Mat3 curvature(const Vec3& n_B) const {
    const Vec3 around = n_B.cross(Vec3::UnitZ());
    return -1 / radius * around * around.transpose();
  }
  double reach(const Pose&) const { return std::numeric_limits<double>::infinity(); }
  MassProperties mass_properties() const { throw std::invalid_argument("a tube has no mass"); }
  double least_width() const { return std::numeric_limits<double>::infinity(); }
  template <class Parts>
  void surface(Parts& parts) const {
    constexpr double endless = std::numeric_limits<double>::infinity();
    parts.add(Parts::Kind::hollow, {radius, radius, 0}, Vec3::Constant(endless));
  }
};

}  // namespace silt::rigid
