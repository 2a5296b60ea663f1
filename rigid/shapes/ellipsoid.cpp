#include "rigid/shapes/ellipsoid.hpp"

#include <array>
#include <numbers>

namespace silt::rigid {
namespace {

/// The equation |p(u)| = 1 for u >= 0, with p_i = c_i / (u + d_i), c_i >= 0, d_i >= 0 and one d_i = 0.
struct SecularEquation {
  Vec3 c, d;

  Vec3 p(double u) const {
    Vec3 p;
    for (int i = 0; i < 3; ++i) p[i] = c[i] > 0 ? c[i] / (u + d[i]) : 0;
    return p;
  }

  /// Returns the root, or 0 if |p| < 1 for all u > 0 (then the terms with d_i = 0 supply the difference).
  /// Newton's method on 1 / |p(u)| = 1, which is concave and increasing: the iterates approach the root from
  /// the left, and the iteration ends when they no longer increase.
  double root() const {
    constexpr int most = 100;  // 3 to 8 iterations are usual
    double u = 0;
    for (int i = 0; i < 3; ++i) u = std::max(u, c[i] - d[i]);  // so that no single term exceeds 1
    for (int k = 0; k < most; ++k) {
      const Vec3 at = p(u);
      const double norm = at.norm();
      if (!(norm > 1)) break;
      double slope = 0;  // of -|p|^2 / 2
      for (int i = 0; i < 3; ++i)
        if (c[i] > 0) slope += at[i] * at[i] / (u + d[i]);
      const double next = u + (norm - 1) * norm * norm / slope;
      if (!(next > u)) break;
      u = next;
    }
    return u;
  }
};

/// Returns the axis numbers, longest axis first.
std::array<int, 3> by_length(const Vec3& half_axes) {
  std::array<int, 3> order{0, 1, 2};
  std::stable_sort(order.begin(), order.end(), [&](int i, int j) { return half_axes[i] > half_axes[j]; });
  return order;
}

/// Returns the distance to the nearest surface point, without cancellation. In the octant of y = |x| that
/// point is e_i^2 y_i / (t + e_i^2), with t the largest root. The equation is scaled with the shortest half
/// axis e: u = t / e^2 + 1, r_i = e_i^2 / e^2, d_i = r_i - 1.
double distance_to_surface(const Vec3& half_axes, const Vec3& x) {
  const Vec3 y = x.cwiseAbs();
  const int shortest = by_length(half_axes)[2];
  const double e = half_axes[shortest];
  SecularEquation equation;
  for (int i = 0; i < 3; ++i) {
    equation.d[i] = (half_axes[i] - e) / e * ((half_axes[i] + e) / e);
    equation.c[i] = half_axes[i] / e * (y[i] / e);  // r_i y_i / e_i
  }
  const double u = equation.root();
  Vec3 way;  // from y to the nearest point
  for (int i = 0; i < 3; ++i) way[i] = equation.c[i] > 0 ? y[i] * (1 - u) / (u + equation.d[i]) : 0;
  if (u == 0) {  // y is in the middle plane, with nearest points on both sides of it
    const Vec3 p = equation.p(u);
    const double others = p.squaredNorm() - p[shortest] * p[shortest];
    way[shortest] = e * std::sqrt(std::max(0.0, 1 - others));
  }
  return way.norm();
}

}  // namespace

double Ellipsoid::signed_distance(const Vec3& x) const {
  const double distance = distance_to_surface(half_axes, x);
  if (contains(x)) return -distance;
  return std::max(distance, std::numeric_limits<double>::min());
}

/// Intersects the line with the unit sphere, in coordinates scaled with the half axes.
std::optional<LineInterval> Ellipsoid::line_interval(const Vec3& o, const Vec3& d) const {
  const Vec3 p = o.cwiseQuotient(half_axes), v = d.cwiseQuotient(half_axes);
  const double a = v.squaredNorm(), b = p.dot(v), distance = p.norm();
  const double closest = (p - b / a * v).norm();  // distance of line and centre: exact for grazing lines, too
  if (!(closest <= 1)) return {};
  const double s = std::sqrt(a * (1 - closest) * (1 + closest)), q = b >= 0 ? -b - s : -b + s;
  const double t1 = q / a, t2 = q != 0 ? (distance - 1) * (distance + 1) / q : 0.0;
  return LineInterval{std::min(t1, t2), std::max(t1, t2)};
}

BoundingBox Ellipsoid::bounding_box(const Pose& pose) const {
  const Mat3 r = pose.orientation.toRotationMatrix();
  return BoundingBox::around(pose.position, (r * half_axes.asDiagonal()).rowwise().norm());
}

/// Finds the furthest point like the nearest one, with the root beyond minus the square of the longest half
/// axis: x_i = -e_i^2 y_i / (u + e^2 - e_i^2).
double Ellipsoid::reach(const Pose& pose) const {
  const Vec3 y = (pose.orientation.conjugate() * pose.position).cwiseAbs();
  const int longest = by_length(half_axes)[0];
  const double e = half_axes[longest];
  SecularEquation equation;
  for (int i = 0; i < 3; ++i) {
    equation.d[i] = (e - half_axes[i]) / e * ((e + half_axes[i]) / e);
    equation.c[i] = half_axes[i] / e * (y[i] / e);
  }
  const double u = equation.root();
  Vec3 p = equation.p(u);
  if (u == 0) p[longest] = std::sqrt(std::max(0.0, 1 - (p.squaredNorm() - p[longest] * p[longest])));
  return (y + half_axes.cwiseProduct(p)).norm();
}

MassProperties Ellipsoid::mass_properties() const {
  const Vec3 sq = half_axes.cwiseAbs2();
  const double volume = 4.0 / 3 * std::numbers::pi * half_axes.prod();
  return {volume, Vec3::Zero(),
          0.2 * volume * Vec3(sq[1] + sq[2], sq[0] + sq[2], sq[0] + sq[1]).asDiagonal()};
}

/// Adds the largest ball, and the points of a cube's edges projected onto the surface.
void Ellipsoid::add_inner_balls(std::vector<InnerBall>& balls) const {
  constexpr int points = 5;  // along an edge
  balls.push_back({Vec3::Zero(), half_axes.minCoeff()});
  for (int i = 0; i < points; ++i)
    for (int j = 0; j < points; ++j)
      for (int k = 0; k < points; ++k) {
        const Vec3 at = Vec3(i, j, k) * (2. / (points - 1)) - Vec3::Ones();
        if (at.cwiseAbs().maxCoeff() == 1) balls.push_back({half_axes.cwiseProduct(at.normalized()), 0});
      }
}

/// The curvature of the level set of f(x) = 1/2 x.D x is D projected across the normal, divided by |D x|.
std::optional<Mat3> Ellipsoid::curvature(const Vec3& x, const Vec3& n) const {
  const Vec3 d = half_axes.cwiseAbs2().cwiseInverse();
  const double gradient = d.cwiseProduct(x).norm();
  if (gradient == 0) return std::nullopt;
  return (across(n) * d.asDiagonal() * across(n)) / gradient;
}

Mat3 Ellipsoid::support_derivative(const Vec3& n) const {
  const Vec3 squares = half_axes.cwiseAbs2(), an = squares.cwiseProduct(n);
  const double q = std::sqrt(an.dot(n));
  Mat3 k = -an * an.transpose() / (q * q);
  k.diagonal() += squares;
  return k / q;
}

}  // namespace silt::rigid
