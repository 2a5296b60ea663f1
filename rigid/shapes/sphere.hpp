#pragma once
#include <numbers>

#include "rigid/shapes/box.hpp"

namespace silt::rigid {

struct Sphere {
  static constexpr std::string_view name = "sphere";
  double radius;
  bool operator==(const Sphere&) const = default;
  static constexpr auto fields = std::tuple{radius_field(&Sphere::radius)};

  double signed_distance(const Vec3& x) const { return x.norm() - radius; }
  std::optional<LineInterval> line_interval(const Vec3& o, const Vec3& d) const {
    return in_ball(radius, o, d);
  }
  BoundingBox bounding_box(const Pose& pose) const {
    return BoundingBox::around(pose.position, Vec3::Constant(radius));
  }
  double reach(const Pose& pose) const { return pose.position.norm() + radius; }
  Vec3 support(const Vec3& n) const { return radius * n; }
  MassProperties mass_properties() const {
    const double volume = 4.0 / 3 * std::numbers::pi * radius * radius * radius;
    return {volume, Vec3::Zero(), 0.4 * volume * radius * radius * Mat3::Identity()};
  }
  double least_width() const { return 2 * radius; }
  void add_inner_balls(std::vector<InnerBall>& balls) const { balls.push_back({Vec3::Zero(), radius}); }

  Mat3 curvature(const Vec3&, const Vec3& n) const { return across(n) / radius; }
  Box core() const { return {Vec3::Zero()}; }
  double core_radius() const { return radius; }
  template <class Use>
  void extremes(Use&& use) const {
    use.ball(Vec3::Zero(), radius, 0);
  }
  template <class Parts>
  void surface(Parts& parts) const {
    parts.add_unturned(SurfaceKind::sphere, Vec3::Constant(radius));
  }
};

}  // namespace silt::rigid
