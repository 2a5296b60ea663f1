#pragma once
#include "rigid/math/elementary.hpp"
#include "rigid/shapes/disc.hpp"
#include "rigid/shapes/solid.hpp"

namespace silt::rigid {

/// Round about the body's z axis, with a flat base that looks along -z. The origin is its centre of mass: the
/// base lies at -height / 4, the apex at 3 height / 4.
struct Cone {
  static constexpr std::string_view name = "cone";
  double radius, height;
  bool operator==(const Cone&) const = default;
  static constexpr auto fields =
      std::tuple{Field<Cone, double>{"height", &Cone::height, "from the base to the apex, along z"},
                 radius_field(&Cone::radius)};

  double signed_distance(const Vec3& x) const;
  std::optional<LineInterval> line_interval(const Vec3& o, const Vec3& d) const;
  BoundingBox bounding_box(const Pose&) const;
  double reach(const Pose&) const;
  Vec3 support(const Vec3& n) const;
  MassProperties mass_properties() const;
  double least_width() const { return std::min(height, 2 * radius * height / slant()); }
  void add_inner_balls(std::vector<InnerBall>&) const;

  std::optional<Mat3> curvature(const Vec3& x, const Vec3& n) const;
  Mat3 support_derivative(const Vec3& n) const;
  void kinks(const Placement&, const Vec3& n_B, double angle, Kinks& out) const;
  static constexpr bool is_revolved = true;
  InnerBall inner_ball(const Vec3& x) const;
  double touching_ball(const Vec3& x, const Vec3& n) const;
  void touching_outline(const Placement&, const Vec3& n, double slack, ContactOutline& out) const;
  void facing_outline(const Placement&, const Vec3& n, ContactOutline& out) const;
  void plane_points(const Placement&, const Vec3& n, std::vector<PlanePoint>& out) const;
  template <class Use>
  void extremes(Use&& use) const {
    use.disc(base().z, radius, 0);
    use.ball(apex(), 0, 2);
  }
  /// Adds the cone about the middle of its height.
  template <class Parts>
  void surface(Parts& parts) const {
    parts.add_shifted(SurfaceKind::cone, {0, 0, apex()[2] - height / 2}, {radius, radius, height / 2});
  }

 private:
  Vec3 apex() const { return {0, 0, 0.75 * height}; }
  Disc base() const { return {radius, -0.25 * height, -1}; }
  double slant() const { return elementary::hypot(radius, height); }
  /// Returns how much further along n the apex is than the rim.
  double apex_lead(const Vec3& n) const { return n[2] * height - radius * elementary::hypot(n[0], n[1]); }
  /// Returns how far x is outside the plane that touches the side where it is nearest to x.
  double above_side(const Vec3& x) const;
  void side_line(const Placement&, const Vec3& n, ContactOutline& out) const;
};

}  // namespace silt::rigid
