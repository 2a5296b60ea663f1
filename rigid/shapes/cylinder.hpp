#pragma once
#include "rigid/math/elementary.hpp"
#include "rigid/shapes/disc.hpp"
#include "rigid/shapes/solid.hpp"

namespace silt::rigid {

/// A cylinder about the body's z axis with flat ends at -half_length and +half_length.
struct Cylinder {
  static constexpr std::string_view name = "cylinder";
  double radius, half_length;
  bool operator==(const Cylinder&) const = default;
  static constexpr auto fields =
      std::tuple{Field<Cylinder, double>{"length", &Cylinder::half_length, "from end to end, along z", 0.5},
                 radius_field(&Cylinder::radius)};

  double signed_distance(const Vec3& x) const;
  std::optional<LineInterval> line_interval(const Vec3& o, const Vec3& d) const;
  BoundingBox bounding_box(const Pose&) const;
  double reach(const Pose&) const;
  Vec3 support(const Vec3& n) const {
    const double across = elementary::hypot(n[0], n[1]), scale = across > 0 ? radius / across : 0;
    return {scale * n[0], scale * n[1], std::copysign(half_length, n[2])};
  }
  MassProperties mass_properties() const;
  double least_width() const { return 2 * std::min(radius, half_length); }
  void add_inner_balls(std::vector<InnerBall>&) const;

  std::optional<Mat3> curvature(const Vec3& x, const Vec3& n) const;
  Vec3 half_widths() const { return {radius, radius, half_length}; }
  Mat3 support_derivative(const Vec3& n) const { return rim_derivative(radius, n); }
  void kinks(const Placement&, const Vec3& n_B, double angle, Kinks& out) const;
  static constexpr bool is_revolved = true;
  InnerBall inner_ball(const Vec3& x) const;
  double touching_ball(const Vec3& x, const Vec3& n) const;
  void touching_outline(const Placement&, const Vec3& n, double slack, ContactOutline& out) const;
  void facing_outline(const Placement&, const Vec3& n, ContactOutline& out) const;
  void plane_points(const Placement&, const Vec3& n, std::vector<PlanePoint>& out) const;
  template <class Use>
  void extremes(Use&& use) const {
    use.disc(-half_length, radius, 0);
    use.disc(half_length, radius, 2);
  }
  template <class Parts>
  void surface(Parts& parts) const {
    parts.add(SurfaceKind::cylinder, half_widths());
  }

 private:
  Disc end(int side) const { return {radius, side * half_length, side}; }
  void side_line(const Placement&, const Vec3& n, ContactOutline& out) const;
};

}  // namespace silt::rigid
