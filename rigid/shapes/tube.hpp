#pragma once
#include <numbers>
#include <stdexcept>

#include "rigid/shapes/solid.hpp"

namespace silt::rigid {

/// All points at least `radius` from the z axis, without end: a wall round about what is inside
/// (hollow_shape.hpp).
struct Tube {
  static constexpr std::string_view name = "tube";
  double radius;
  bool operator==(const Tube&) const = default;
  static constexpr auto fields = std::tuple{radius_field(&Tube::radius)};
  static constexpr bool slides = true;

  double signed_distance(const Vec3& x) const { return radius - std::sqrt(x[0] * x[0] + x[1] * x[1]); }
  double gap(const Pose& at, const Vec3& x) const { return radius - from_axis(at, x).norm(); }
  /// A point on the axis has the x axis.
  Vec3 outward(const Pose& at, const Vec3& x) const {
    const Vec3 from = from_axis(at, x);
    const double distance = from.norm();
    return distance > 0 ? Vec3(from / distance) : Vec3(at.orientation * Vec3::UnitX());
  }
  double ray_distance(const Vec3& o, const Vec3& d, double t_max) const {
    const double a = d[0] * d[0] + d[1] * d[1], rho = std::sqrt(o[0] * o[0] + o[1] * o[1]);
    if (!(a > 0)) return rho < radius ? t_max : 0.0;
    const auto hole = between_roots(a, o[0] * d[0] + o[1] * d[1], (rho - radius) * (rho + radius));
    return hole ? std::clamp(hole->leave, 0.0, t_max) : 0.0;
  }
  Mat3 curvature(const Vec3& n_B) const {
    const Vec3 around = n_B.cross(Vec3::UnitZ());
    return -1 / radius * around * around.transpose();
  }
  BoundingBox hole(const Pose& at) const {
    constexpr double straight = 1e-12;  // rounding of a unit vector
    const Vec3 axis = at.orientation * Vec3::UnitZ();
    Vec3 half = Vec3::Constant(radius);
    for (int d = 0; d < 3; ++d)
      if (std::abs(axis[d]) > straight) half[d] = std::numeric_limits<double>::infinity();
    return BoundingBox::around(at.position, half);
  }
  Vec3 innermost(const Vec3& x) const { return {0, 0, x[2]}; }
  double widest() const { return radius; }
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
    parts.add(Parts::Kind::hollow, {radius, radius, 0}, Vec3::Constant(endless));
  }

 private:
  static Vec3 from_axis(const Pose& at, const Vec3& x) {
    const Vec3 from = x - at.position, axis = at.orientation * Vec3::UnitZ();
    return from - axis.dot(from) * axis;
  }
};

}  // namespace silt::rigid
