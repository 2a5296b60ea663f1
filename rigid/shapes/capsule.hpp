#pragma once
#include "rigid/shapes/box.hpp"

namespace silt::rigid {

/// A segment along the body's z axis from -half_length to +half_length, swept by a sphere.
struct Capsule {
  static constexpr std::string_view name = "capsule";
  double radius, half_length;
  bool operator==(const Capsule&) const = default;
  static constexpr auto fields =
      std::tuple{Field<Capsule, double>{"length", &Capsule::half_length,
                                        "of the segment between the centres of the two ends", 0.5},
                 radius_field(&Capsule::radius)};

  double signed_distance(const Vec3& x) const;
  std::optional<LineInterval> line_interval(const Vec3& o, const Vec3& d) const;
  BoundingBox bounding_box(const Pose&) const;
  double reach(const Pose&) const;
  Vec3 support(const Vec3& n) const { return radius * n + Vec3(0, 0, std::copysign(half_length, n[2])); }
  MassProperties mass_properties() const;
  double least_width() const { return 2 * radius; }
  void add_inner_balls(std::vector<InnerBall>&) const;

  Mat3 curvature(const Vec3& x, const Vec3& n) const;
  Box core() const { return {{0, 0, half_length}}; }
  double core_radius() const { return radius; }
  template <class Use>
  void extremes(Use&& use) const {
    use.ball({0, 0, -half_length}, radius, 0);
    use.ball({0, 0, half_length}, radius, 1);
  }
  template <class Parts>
  void surface(Parts& parts) const {
    parts.add(SurfaceKind::capsule, {radius, radius, half_length}, {radius, radius, radius + half_length});
  }
};

}  // namespace silt::rigid
