#pragma once
#include <numbers>
#include <stdexcept>

#include "rigid/shapes/solid.hpp"

namespace silt::rigid {

/// All points at least `radius` from the z axis: a wall around an infinite cylindrical hole. It is not convex
/// and has infinite mass; collision backends do not handle it (rigid/collision/tube_contacts.hpp does).
struct Tube {
  static constexpr std::string_view name = "tube";
  double radius;
  bool operator==(const Tube&) const = default;
  static constexpr auto fields = std::tuple{radius_field(&Tube::radius)};

  double signed_distance(const Vec3& x) const { return radius - std::sqrt(x[0] * x[0] + x[1] * x[1]); }
  /// Returns the signed distance; outward() the unit direction to the nearest wall point; frame of the pose.
  double gap(const Pose& at, const Vec3& x) const { return radius - from_axis(at, x).norm(); }
  /// For a point on the axis the direction is the tube's x axis.
  Vec3 outward(const Pose& at, const Vec3& x) const {
    const Vec3 from = from_axis(at, x);
    const double distance = from.norm();
    return distance > 0 ? Vec3(from / distance) : Vec3(at.orientation * Vec3::UnitX());
  }
  /// Returns the curvature tensor where the wall's outward normal is n; its eigenvalues are <= 0.
  Mat3 curvature(const Vec3& n_B) const {
    const Vec3 around = n_B.cross(Vec3::UnitZ());
    return -1 / radius * around * around.transpose();
  }
  /// Returns the axis-aligned box of the hole in the frame of the pose.
  BoundingBox hole(const Pose& at) const {
    constexpr double straight = 1e-12;  // rounding of a unit vector
    const Vec3 axis = at.orientation * Vec3::UnitZ();
    Vec3 half = Vec3::Constant(radius);
    for (int d = 0; d < 3; ++d)
      if (std::abs(axis[d]) > straight) half[d] = std::numeric_limits<double>::infinity();
    return BoundingBox::around(at.position, half);
  }
  /// Returns the approximate area of the surface within a box of this size.
  double area(const Vec3& axis, const Vec3& size) const {
    return 2 * std::numbers::pi * radius * axis.cwiseAbs().dot(size);
  }

  BoundingBox bounding_box(const Pose&) const { return BoundingBox::everything(); }
  double reach(const Pose&) const { return std::numeric_limits<double>::infinity(); }
  MassProperties mass_properties() const { throw std::invalid_argument("a tube has no mass"); }
  double least_width() const { return std::numeric_limits<double>::infinity(); }
  template <class Parts>
  void surface(Parts& parts) const {
    constexpr double endless = std::numeric_limits<double>::infinity();
    parts.add(SurfaceKind::tube, {radius, radius, 0}, Vec3::Constant(endless));
  }

 private:
  static Vec3 from_axis(const Pose& at, const Vec3& x) {
    const Vec3 from = x - at.position, axis = at.orientation * Vec3::UnitZ();
    return from - axis.dot(from) * axis;
  }
};

}  // namespace silt::rigid
