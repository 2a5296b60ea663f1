#include "rigid/collision/deepest_direction.hpp"

#include <cmath>
#include <utility>

namespace silt::rigid {

namespace {

constexpr double height_rounding = 2e-15;  // part of the pair's size: differences of height below it are none
constexpr double parallel_sine = 1e-8;
/// Radian, squared: after a step of Newton's method this small the next one is rounding; and so it is after
/// one of the second size that is not much smaller than the one before.
constexpr double last_step = 1e-22, small_step = 1e-12;
constexpr int most_steps = 30;
constexpr double least_share = 0.125;  // of a step that would lead downhill

/// Where the search is bound to: all directions, or those on a circle.
struct Track {
  const Kinks::Circle* circle = nullptr;

  /// The part of v across the circle's axis.
  Vec3 across(const Vec3& v) const { return circle ? Vec3(v - v.dot(circle->axis) * circle->axis) : v; }
  /// The direction on the circle on the side of unit e, across its axis.
  Vec3 direction(const Vec3& e) const {
    if (!circle || circle->c == 0) return e;
    return circle->c * circle->axis + std::sqrt(1 - circle->c * circle->c) * e;
  }
};

/// The step of Newton's method in the tangent plane at n; nothing where the height is not curved downwards.
/// On a circle n = c a + s e, s^2 = 1 - c^2, with the tangent t = a x e: along t by x, s (s t.K t + e.D) x =
/// s t.D.
std::optional<Vec3> newton_step(const Vec3& n, const Vec3& d, const Mat3& k, const Track& track) {
  const double height = n.dot(d);
  if (track.circle && track.circle->c == 0) {
    const Vec3 t = track.circle->axis.cross(n);
    const double slope_change = t.dot(k * t) + height;
    if (!(slope_change > 0)) return {};
    return t * (t.dot(d) / slope_change);
  }
  if (track.circle) {
    const Vec3 e = track.across(n).normalized(), t = track.circle->axis.cross(e);
    const double s = std::sqrt(1 - track.circle->c * track.circle->c);
    const double slope_change = s * t.dot(k * t) + e.dot(d);
    if (!(slope_change > 0)) return {};
    return t * (s * t.dot(d) / slope_change);
  }
  const Vec3 t = n.unitOrthogonal(), u = n.cross(t);
  const double tt = t.dot(k * t) + height, tu = t.dot(k * u), uu = u.dot(k * u) + height;
  const double det = tt * uu - tu * tu, rt = t.dot(d), ru = u.dot(d);
  if (!(det > 0 && tt + uu > 0)) return {};
  return (t * (uu * rt - tu * ru) + u * (tt * ru - tu * rt)) / det;
}

/// Up to where the slope vanishes, or where it turns at a kink, both cores changing their support as they do;
/// nothing where that fails. Heights that differ by `rounding` are equal.
std::optional<Vec3> climb_smooth(const ConvexCore& a, const ConvexCore& b, const Vec3& from,
                                 const Track& track, double rounding) {
  Vec3 n = track.across(from);
  const double length = n.norm();
  if (!(length > 0.1)) return {};
  n = track.direction(n / length);
  Vec3 d = b.support(-n) - a.support(n);
  if (!a.curved() && !b.curved()) {  // the nearest points are vertices, or on the edge
    const Vec3 within = track.across(d);
    const double distance = within.norm();
    if (!(within.dot(n) > 0)) return {};
    return track.direction(
        track.across(within / distance).normalized());  // again: of a small remainder little is left normal
  }
  double moved = std::numeric_limits<double>::infinity();
  for (int i = 0; i < most_steps; ++i) {
    const auto step = newton_step(n, d, a.support_derivative(n) + b.support_derivative(-n), track);
    if (!step) return {};
    const double height = n.dot(d), before = std::exchange(moved, step->squaredNorm());
    const bool is_last = moved < last_step || (moved < small_step && moved > before / 4);
    const auto after = [&](double share) -> Vec3 {
      return track.direction(track.across(n + share * *step).normalized());
    };
    if (is_last) return after(1);
    Vec3 next;
    for (double share = 1;; share /= 2) {
      if (share < least_share) return n;
      next = after(share);
      d = b.support(-next) - a.support(next);
      if (next.dot(d) >= height - rounding) break;
    }
    n = next;
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

/// Of the directions on both circles the one nearer to n; nothing where the axes are parallel or the circles
/// do not cross.
std::optional<Vec3> on_both(const Kinks::Circle& u, const Kinks::Circle& v, const Vec3& n) {
  const Vec3 cross = u.axis.cross(v.axis);
  const double sine = cross.norm();
  if (!(sine > parallel_sine)) return {};
  if (u.c == 0 && v.c == 0) return cross.dot(n) < 0 ? Vec3(-cross / sine) : Vec3(cross / sine);
  const double cosine = u.axis.dot(v.axis), square = sine * sine;
  const Vec3 within =
      ((u.c - v.c * cosine) * u.axis + (v.c - u.c * cosine) * v.axis) / square;  // in the plane of the axes
  const double rest = 1 - within.squaredNorm();
  if (!(rest >= 0)) return {};
  const Vec3 out = std::sqrt(rest) / sine * cross;
  return Vec3(within + (cross.dot(n) < 0 ? -1 : 1) * out).normalized();
}

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
  for (Kinks::Circle& circle : of_b.circles) circle.c = -circle.c;  // of b they are those of -n
  for (const Kinks::Circle& u : of_a.circles)
    for (const Kinks::Circle& v : of_b.circles)
      if (const auto crossing = on_both(u, v, n)) best.take(*crossing);
  for (const Kinks* kinks : {&of_a, &of_b})
    for (const Kinks::Circle& circle : kinks->circles)
      if (const auto on_circle = climb_smooth(a, b, n, {&circle}, handicap)) best.take(*on_circle);
  if (const auto smooth = climb_smooth(a, b, n, {}, handicap)) best.take(*smooth);
  return best.peak;
}

}  // namespace

Peak climb(const ConvexCore& a, const ConvexCore& b, const Vec3& n, double angle, int most_rounds) {
  const double handicap = height_rounding * length_scale(a, b);
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
