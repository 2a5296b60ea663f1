#pragma once
#include <cmath>

#include "rigid/math/elementary.hpp"
#include "rigid/shapes/solid.hpp"

namespace silt::rigid {

/// The flat round end of a shape of revolution: a disc across the z axis with the outward normal side * z.
struct Disc {
  double radius, z;
  int side;  // -1 or 1

  /// Number of rim points that represent the disc, at fixed angles of its frame.
  static constexpr int rim_points = 8;
  /// Sine of the largest tilt at which the disc counts as flat against a plane. Beyond it only the furthest
  /// rim point can touch: fixed points beside it would be stopped above the plane.
  static constexpr double flat_sine = 0.1;

  // Feature codes of a shape of revolution: 0 is unused; then the rim points of both ends, the chords between
  // them, the ends, the side, and for each end the rim point furthest along the normal.
  static constexpr std::uint32_t first_rim = 1, first_chord = first_rim + 2 * rim_points,
                                 first_end = first_chord + 2 * rim_points, side_code = first_end + 2,
                                 first_lowest = side_code + 1;

  bool is_flat_against(const Vec3& n_B) const {
    return (n_B.z() < 0) == (side < 0) && elementary::hypot(n_B.x(), n_B.y()) <= flat_sine;
  }
  /// Returns the rim point furthest along n.
  ContactOutline::Corner lowest(const Placement&, const Vec3& n) const;
  void outline(const Placement&, ContactOutline& out) const;
  /// Adds the candidates for contact with a plane normal to n: the lowest rim point, and if the disc is flat
  /// against the plane the fixed rim points as well.
  void add_plane_points(const Placement&, const Vec3& n, std::vector<PlanePoint>& out) const;
};

/// Returns the derivative, by the unit direction n, of the support point of a circle of this radius about z.
Mat3 rim_derivative(double radius, const Vec3& n);

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
