#include "rigid/shapes/curvature.hpp"

#include <algorithm>
#include <cmath>

namespace silt::rigid {

namespace {

Mat3 across(const Vec3& n) {
  return Mat3::Identity() - n * n.transpose();
}

struct CurvatureOf {
  const Vec3 &x, &n;

  std::optional<Mat3> operator()(const Sphere& s) const { return across(n) / s.radius; }
  std::optional<Mat3> operator()(const HalfSpace&) const { return Mat3::Zero(); }
  /// Bent along the axis only where the ends are.
  std::optional<Mat3> operator()(const Capsule& c) const {
    Mat3 k = across(n) / c.radius;
    if (std::abs(x[2]) <= c.half_length) k.row(2).setZero(), k.col(2).setZero();
    return k;
  }
  /// Of f(x) = 1/2 x.D x = const: the part of D across the normal, over |D x|.
  std::optional<Mat3> operator()(const Ellipsoid& e) const {
    const Vec3 d = e.half_axes.cwiseAbs2().cwiseInverse();
    const double gradient = d.cwiseProduct(x).norm();
    if (gradient == 0) return std::nullopt;
    return (across(n) * d.asDiagonal() * across(n)) / gradient;
  }
  template <class Other>
  std::optional<Mat3> operator()(const Other&) const {
    return std::nullopt;
  }
};

}  // namespace

std::optional<Mat3> curvature(const ConvexShape& shape, const Vec3& x_B, const Vec3& n_B) {
  return std::visit(CurvatureOf{x_B, n_B}, shape);
}

bool is_smooth(const ConvexShape& shape) {
  return !std::holds_alternative<Box>(shape) && !std::holds_alternative<Cylinder>(shape) &&
         !std::holds_alternative<Polyhedron>(shape);
}

}  // namespace silt::rigid
