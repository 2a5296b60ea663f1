#include "rigid/collision/deepest_direction.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace silt::rigid {

namespace {

/// Up to four points of the difference b - a, and the point of their hull nearest to the origin.
struct Simplex {
  std::array<Vec3, 4> w;
  int size = 0;

  /// The point nearest to the origin; keeps only the points it lies between. Zero where the origin is inside.
  Vec3 reduce() {
    switch (size) {
      case 1:
        return w[0];
      case 2:
        return on_edge();
      case 3:
        return on_triangle();
      default:
        return in_tetrahedron();
    }
  }

 private:
  Vec3 keep(const Simplex& s, const Vec3& x) {
    *this = s;
    return x;
  }
  Vec3 on_edge() {
    const Vec3 along = w[1] - w[0];
    const double t = -w[0].dot(along), l2 = along.squaredNorm();
    if (t <= 0) return size = 1, w[0];
    if (t >= l2) return w[0] = w[1], size = 1, w[0];
    return w[0] + t / l2 * along;
  }
  Vec3 on_triangle() {
    const Vec3 normal = (w[1] - w[0]).cross(w[2] - w[0]);
    bool inside = normal.squaredNorm() > 0;
    for (int k = 0; k < 3 && inside; ++k) inside = normal.dot(w[k].cross(w[(k + 1) % 3])) >= 0;
    if (inside) return normal * (normal.dot(w[0]) / normal.squaredNorm());
    return best_of<3, 2>();
  }
  Vec3 in_tetrahedron() {
    bool inside = true;
    for (int k = 0; k < 4 && inside; ++k) {
      const Vec3 &p = w[k], &q = w[(k + 1) % 4], &r = w[(k + 2) % 4], &opposite = w[(k + 3) % 4];
      const Vec3 normal = (q - p).cross(r - p);
      const double origin = -normal.dot(p), other = normal.dot(opposite - p);
      inside = origin * other > 0;
    }
    if (inside) return Vec3::Zero();
    return best_of<4, 3>();
  }
  /// The nearest of the simplices of one point less.
  template <int points, int fewer>
  Vec3 best_of() {
    Simplex best = *this;
    Vec3 nearest = Vec3::Zero();
    double least = std::numeric_limits<double>::infinity();
    for (int leave_out = 0; leave_out < points; ++leave_out) {
      Simplex s = *this;
      std::copy(w.begin() + leave_out + 1, w.begin() + points, s.w.begin() + leave_out);
      s.size = fewer;
      const Vec3 x = s.reduce();
      if (x.squaredNorm() < least) least = x.squaredNorm(), nearest = x, best = s;
    }
    return keep(best, nearest);
  }
};

/// `size`: what rounding is relative to.
template <class A, class B>
std::optional<Vec3> nearest_direction(const A& a, const B& b, const Vec3& shift, const Vec3& start,
                                      double size) {
  constexpr int most_rounds = 40;
  constexpr double enough = 1e-8;  // relative: the square of the direction's error
  const double touching = 1e-9 * size, rounding = 1e-15 * size;
  Simplex simplex;
  Vec3 n = start;
  double distance = 0;
  for (int round = 0; round < most_rounds; ++round) {
    const Vec3 w = b.support(-n) - a.support(n) + shift;
    if (round > 0 && distance - n.dot(w) <= enough * distance + rounding) return n;
    for (int k = 0; k < simplex.size; ++k)
      if (simplex.w[k] == w) return n;
    simplex.w[simplex.size++] = w;
    const Vec3 nearest = simplex.reduce();
    distance = nearest.norm();
    if (!(distance > touching)) return {};
    n = nearest / distance;
  }
  return n;
}

}  // namespace

std::optional<Vec3> gjk_direction(const ConvexCore& a, const ConvexCore& b, const Vec3& shift,
                                  const Vec3& start) {
  return nearest_direction(a, b, shift, start, length_scale(a, b));
}

std::optional<Vec3> gjk_direction(const SweptCore& a, const ShrunkCore& b, const Vec3& start, double size) {
  return nearest_direction(a, b, Vec3::Zero(), start, size);
}

Vec3 walk_uphill(const ConvexCore& a, const ConvexCore& b, const Vec3& from) {
  constexpr double apart = 0.02;  // part of the pair's size
  constexpr int most_rounds = 6;
  Vec3 n = from;
  for (int round = 0; round < most_rounds; ++round) {
    const double away = std::max(0.0, apart * length_scale(a, b) - core_separation(a, b, n));
    const auto next = gjk_direction(a, b, away * n, n);
    if (!next) break;
    const double moved = (*next - n).squaredNorm();
    n = *next;
    if (moved < 1e-6 || away == 0) break;
  }
  return n;
}

}  // namespace silt::rigid
