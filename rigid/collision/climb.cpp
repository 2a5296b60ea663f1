#include "rigid/collision/climb.hpp"

#include <cmath>
#include <limits>
#include <optional>

namespace silt::rigid {

namespace {

constexpr double rounding = 2e-15;  // part of the pair's size: differences of height below it are none
constexpr double parallel_sine = 1e-8;
constexpr int most_rounds = 12, most_steps = 30, most_halvings = 6;

/// Where the search is bound to: all directions, or those normal to an edge.
struct Circle {
  const Vec3* edge = nullptr;

  Vec3 onto(const Vec3& v) const { return edge ? Vec3(v - v.dot(*edge) * *edge) : v; }
};

/// The step of Newton's method in the tangent plane at n; nothing where the height is not curved downwards.
std::optional<Vec3> newton_step(const Vec3& n, const Vec3& d, const Mat3& k, const Circle& circle) {
  const double height = n.dot(d);
  if (circle.edge) {
    const Vec3 t = circle.edge->cross(n);
    const double bend = t.dot(k * t) + height;
    if (!(bend > 0)) return {};
    return t * (t.dot(d) / bend);
  }
  const Vec3 t = n.unitOrthogonal(), u = n.cross(t);
  const double tt = t.dot(k * t) + height, tu = t.dot(k * u), uu = u.dot(k * u) + height;
  const double det = tt * uu - tu * tu, rt = t.dot(d), ru = u.dot(d);
  if (!(det > 0 && tt + uu > 0)) return {};
  return (t * (uu * rt - tu * ru) + u * (tt * ru - tu * rt)) / det;
}

/// Up to where the slope vanishes, the curvature being that of both cores; nothing where that fails.
std::optional<Vec3> climb_smooth(const ConvexCore& a, const ConvexCore& b, const Vec3& from,
                                 const Circle& circle) {
  Vec3 n = circle.onto(from);
  const double length = n.norm();
  if (!(length > 0.1)) return {};
  n /= length;
  Vec3 d = b.support(-n) - a.support(n);
  if (!a.curved() && !b.curved()) {  // the nearest points are vertices, or on the edge
    const Vec3 within = circle.onto(d);
    const double distance = within.norm();
    if (!(within.dot(n) > 0)) return {};
    return circle.onto(within / distance).normalized();  // again: of a small remainder little is left normal
  }
  for (int i = 0; i < most_steps; ++i) {
    const auto step = newton_step(n, d, a.curvature(n) + b.curvature(-n), circle);
    if (!step) return {};
    const double height = n.dot(d);
    double share = 1;
    Vec3 next, d_next;
    for (int k = 0; k <= most_halvings; ++k, share /= 2) {
      next = circle.onto(n + share * *step).normalized();
      d_next = b.support(-next) - a.support(next);
      if (next.dot(d_next) >= height - rounding * d.norm()) break;
    }
    const double moved = (next - n).squaredNorm();
    n = next;
    d = d_next;
    if (moved < 1e-29) break;
  }
  return n;
}

/// Keeps the highest of the directions tried; of equal ones the first.
struct Best {
  const ConvexCore &a, &b;
  double handicap;
  Peak peak{Vec3::Zero(), -std::numeric_limits<double>::infinity()};

  void take(const Vec3& n) {
    const double gap = core_separation(a, b, n);
    if (gap > peak.core_gap + handicap || peak.normal.isZero(0)) peak = {n, gap};
  }
};

/// The highest direction that the features near n allow.
Peak step_up(const ConvexCore& a, const ConvexCore& b, const Vec3& n, double angle, double handicap) {
  thread_local Kinks of_a, of_b;
  of_a.clear();
  of_b.clear();
  a.kinks(n, angle, of_a);
  b.kinks(-n, angle, of_b);
  Best best{a, b, handicap};
  for (const Vec3& face : of_a.faces) best.take(face);
  for (const Vec3& face : of_b.faces) best.take(-face);
  for (const Vec3& u : of_a.edges)
    for (const Vec3& v : of_b.edges) {
      const Vec3 cross = u.cross(v);
      const double sine = cross.norm();
      if (sine > parallel_sine) best.take(cross.dot(n) < 0 ? Vec3(-cross / sine) : Vec3(cross / sine));
    }
  for (const Kinks* kinks : {&of_a, &of_b})
    for (const Vec3& edge : kinks->edges)
      if (const auto on_circle = climb_smooth(a, b, n, {&edge})) best.take(*on_circle);
  if (const auto smooth = climb_smooth(a, b, n, {})) best.take(*smooth);
  return best.peak;
}

}  // namespace

Peak climb(const ConvexCore& a, const ConvexCore& b, const Vec3& n, double angle) {
  const double handicap = rounding * length_scale(a, b);
  Peak peak{n, core_separation(a, b, n)};
  for (int round = 0; round < most_rounds; ++round) {
    const Peak next = step_up(a, b, peak.normal, angle, handicap);
    if (!(next.core_gap >= peak.core_gap - 10 * handicap) || next.normal.isZero(0)) break;
    const bool settled = (next.normal - peak.normal).squaredNorm() < 1e-28;
    const bool rose = next.core_gap > peak.core_gap + handicap;
    peak = next;
    if (settled || (round > 0 && !rose) || (a.smooth() && b.smooth())) break;
  }
  return peak;
}

}  // namespace silt::rigid
