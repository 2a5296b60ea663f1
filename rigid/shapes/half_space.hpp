#pragma once
#include <stdexcept>

#include "rigid/shapes/solid.hpp"

namespace silt::rigid {

/// All points with normal . x_B <= 0, the outward normal being a unit vector. For walls only: infinite mass.
struct HalfSpace {
  static constexpr std::string_view name = "half-space";
  Vec3 normal;
  bool mirrors = false;  // a plane of symmetry: what touches it touches its mirror image
  bool operator==(const HalfSpace&) const = default;
  static constexpr std::tuple<> fields{};  // cases give half-spaces as sides of the domain

  double signed_distance(const Vec3& x) const { return normal.dot(x); }
  std::optional<LineInterval> line_interval(const Vec3& o, const Vec3& d) const {
    constexpr double infinity = std::numeric_limits<double>::infinity();
    const double distance = normal.dot(o), speed = normal.dot(d);
    if (speed == 0) return distance <= 0 ? std::optional{LineInterval::everything()} : std::nullopt;
    const double t = -distance / speed;
    return speed < 0 ? LineInterval{t, infinity} : LineInterval{-infinity, t};
  }
  BoundingBox bounding_box(const Pose&) const { return BoundingBox::everything(); }
  double reach(const Pose&) const { return std::numeric_limits<double>::infinity(); }
  Vec3 support(const Vec3&) const { throw std::invalid_argument("a half-space has no furthest point"); }
  MassProperties mass_properties() const { throw std::invalid_argument("a half-space has no mass"); }
  double least_width() const { return std::numeric_limits<double>::infinity(); }
  void add_inner_balls(std::vector<InnerBall>&) const {}

  Mat3 curvature(const Vec3&, const Vec3&) const { return Mat3::Zero(); }
  template <class Use>
  void extremes(Use&&) const {
    throw std::invalid_argument("a half-space is not in a tube");
  }
  template <class Parts>
  void surface(Parts& parts) const {
    parts.add(SurfaceKind::planes, Vec3::Constant(std::numeric_limits<double>::infinity()));
    parts.add_plane(normal, 0);
  }
};

}  // namespace silt::rigid
