#pragma once
#include "rigid/shapes/solid.hpp"

namespace silt::rigid {

struct Ellipsoid {
  static constexpr std::string_view name = "ellipsoid";
  Vec3 half_axes;
  bool operator==(const Ellipsoid&) const = default;
  static constexpr auto fields = std::tuple{Field<Ellipsoid, Vec3>{
      "diameters", &Ellipsoid::half_axes, "how long it is along each of its axes, [x, y, z]", 0.5}};

  bool contains(const Vec3& x) const { return x.cwiseQuotient(half_axes).squaredNorm() <= 1; }
  /// Absolute error below 1e-14 (largest axis + distance) for axes of any ratio; the sign agrees with
  /// contains. Reduction to one root by D. Eberly, "Distance from a Point to an Ellipse, an Ellipsoid, or a
  /// Hyperellipsoid" (2013); the root by Newton's method as in trust regions (More, Sorensen, SIAM J. Sci.
  /// Stat. Comput. 4 (1983)) instead of bisection.
  double signed_distance(const Vec3& x) const;
  std::optional<LineInterval> line_interval(const Vec3& o, const Vec3& d) const;
  BoundingBox bounding_box(const Pose&) const;
  double reach(const Pose&) const;
  Vec3 support(const Vec3& n) const {
    const Vec3 scaled = half_axes.cwiseProduct(n);
    return half_axes.cwiseProduct(scaled) / scaled.norm();
  }
  MassProperties mass_properties() const;
  double least_width() const { return 2 * half_axes.minCoeff(); }
  void add_inner_balls(std::vector<InnerBall>&) const;

  std::optional<Mat3> curvature(const Vec3& x, const Vec3& n) const;
  Vec3 half_widths() const { return half_axes; }
  Mat3 support_derivative(const Vec3& n) const;
  InnerBall inner_ball(const Vec3&) const { return {Vec3::Zero(), half_axes.minCoeff()}; }
  /// Returns (least half axis a)^2 / (width along n), a lower bound of the largest radius: with |m| the norm
  /// sqrt(m.Am), |m||n| - m.An is half the square of a vector's norm, which is at least a^2 (1 - m.n).
  double touching_ball(const Vec3&, const Vec3& n) const {
    const double least = half_axes.minCoeff();
    return least * least / half_axes.cwiseProduct(n).norm();
  }
  template <class Use>
  void extremes(Use&& use) const {
    use.ellipsoid(half_axes, 0);
  }
  /// Adds the unit ball in coordinates scaled with the half axes.
  template <class Parts>
  void surface(Parts& parts) const {
    parts.add_scaled(SurfaceKind::ellipsoid, half_axes.cwiseInverse());
  }
};

}  // namespace silt::rigid
