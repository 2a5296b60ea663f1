#include <algorithm>
#include <array>
#include <cmath>
#include <utility>
#include <vector>

#include "rigid/collision/deepest_direction.hpp"

namespace silt::rigid {
namespace {

/// Bounds that exceed the best by less than this (relative to the pair's size) are not refined.
constexpr double bound_rounding = 1e-12;
/// Limit for pairs whose separation is equal in many directions (concentric bodies of revolution).
constexpr int most_bisections = 6000;

/// A direction and the difference of the support points there.
struct Sample {
  Vec3 n, w;
  double height() const { return n.dot(w); }
};

struct DirectionTriangle {
  double bound;  // upper bound of the separation in the triangle
  std::array<Sample, 3> corner;

  bool operator<(const DirectionTriangle& other) const { return bound < other.bound; }
};

/// Returns the least bound max_j n_j . w over a few mixtures w of the three support differences.
double bound_of(const std::array<Sample, 3>& c) {
  std::array<std::array<double, 3>, 3> m;  // m[i][j] = w_i . n_j
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) m[i][j] = c[i].w.dot(c[j].n);
  double least = std::numeric_limits<double>::infinity();
  const auto mix = [&](double x, double y, double z) {
    double most = -std::numeric_limits<double>::infinity();
    for (int j = 0; j < 3; ++j) most = std::max(most, x * m[0][j] + y * m[1][j] + z * m[2][j]);
    least = std::min(least, most);
  };
  mix(1, 0, 0), mix(0, 1, 0), mix(0, 0, 1);
  mix(0.5, 0.5, 0), mix(0, 0.5, 0.5), mix(0.5, 0, 0.5);
  mix(1.0 / 3, 1.0 / 3, 1.0 / 3);
  if (!(least > 0)) return least;
  const Vec3 area = (c[1].n - c[0].n).cross(c[2].n - c[0].n);
  return least * area.norm() / std::abs(area.dot(c[0].n));
}

class Search {
 public:
  Search(const ConvexCore& a, const ConvexCore& b, const Peak& seed, double enough)
      : a_(a), b_(b), slack_(bound_rounding * length_scale(a, b)), enough_(enough), best_(seed) {}

  std::optional<Peak> run() {
    start_with_octants();
    for (int halving = 0; !heap_.empty() && best_.core_gap <= enough_; ++halving) {
      std::pop_heap(heap_.begin(), heap_.end());
      const DirectionTriangle t = heap_.back();
      heap_.pop_back();
      if (t.bound <= best_.core_gap + slack_ || halving >= most_bisections) break;
      halve(t.corner);
    }
    if (best_.core_gap > enough_) return {};
    return best_;
  }

 private:
  /// Starts with octants rotated off the axes, to which shapes are often aligned.
  void start_with_octants() {
    const Mat3 turn =
        Quat(0.8414709848, 0.3141592654, -0.2718281828, 0.3466020610).normalized().toRotationMatrix();
    std::array<Sample, 6> axis;
    for (int k = 0; k < 6; ++k) axis[k] = sample((k < 3 ? 1.0 : -1.0) * turn.col(k % 3));
    heap_.reserve(64);
    for (int octant = 0; octant < 8; ++octant)
      push({axis[octant & 1 ? 0 : 3], axis[octant & 2 ? 1 : 4], axis[octant & 4 ? 2 : 5]});
  }

  Sample sample(const Vec3& n) {
    const Sample s{n, b_.support(-n) - a_.support(n)};
    return s;
  }

  void push(const std::array<Sample, 3>& corner) {
    const DirectionTriangle t{bound_of(corner), corner};
    if (t.bound <= best_.core_gap + slack_) return;
    heap_.push_back(t);
    std::push_heap(heap_.begin(), heap_.end());
  }

  void consider(const Peak& peak) {
    if (peak.core_gap > best_.core_gap) best_ = peak;
  }

  void halve(const std::array<Sample, 3>& c) {
    std::array<double, 3> edge;
    for (int k = 0; k < 3; ++k) edge[k] = (c[(k + 1) % 3].n - c[k].n).squaredNorm();
    const int k = std::ranges::max_element(edge) - edge.begin();
    const double length = std::sqrt(edge[k]);
    const Sample &from = c[k], &to = c[(k + 1) % 3], &opposite = c[(k + 2) % 3];
    if (length < search_resolution) {
      if (2 - 2 * best_.normal.dot(from.n) > search_resolution * search_resolution)
        consider(climb(a_, b_, (c[0].n + c[1].n + c[2].n).normalized(), 2 * search_resolution));
      return;
    }
    const Sample middle = sample((from.n + to.n).normalized());
    if (middle.height() > best_.core_gap + slack_)
      consider(climb(a_, b_, walk_uphill(a_, b_, middle.n), search_resolution));
    push({from, middle, opposite});
    push({middle, to, opposite});
  }

  const ConvexCore &a_, &b_;
  double slack_, enough_;
  Peak best_;
  std::vector<DirectionTriangle> heap_;
};

constexpr double height_rounding =
    2e-15;  // relative to the pair's size: smaller height differences are rounding
constexpr double parallel_sine = 1e-8;
/// Squared angles at which Newton's method ends: after a step below last_step, and after one below small_step
/// that is not much smaller than its predecessor.
constexpr double last_step = 1e-22, small_step = 1e-12;
constexpr int most_steps = 30;
constexpr double least_share = 0.125;  // least fraction of a step that would lead downhill

/// The directions that a search may use: all, or those normal to an axis.
struct Track {
  const Vec3* axis = nullptr;

  /// Returns the part of v normal to the axis.
  Vec3 across(const Vec3& v) const { return axis ? Vec3(v - v.dot(*axis) * *axis) : v; }
};

/// Returns Newton's step in the tangent plane at n; nothing unless the height is concave there.
std::optional<Vec3> newton_step(const Vec3& n, const Vec3& d, const Mat3& k, const Track& track) {
  const double height = n.dot(d);
  if (track.axis) {
    const Vec3 t = track.axis->cross(n);
    const double slope_change = t.dot(k * t) + height;
    if (!(slope_change > 0)) return {};
    return t * (t.dot(d) / slope_change);
  }
  const Vec3 t = n.unitOrthogonal(), u = n.cross(t);
  const double tt = t.dot(k * t) + height, tu = t.dot(k * u), uu = u.dot(k * u) + height;
  const double det = tt * uu - tu * tu, rt = t.dot(d), ru = u.dot(d);
  if (!(det > 0 && tt + uu > 0)) return {};
  return (t * (uu * rt - tu * ru) + u * (tt * ru - tu * rt)) / det;
}

/// Climbs to a stationary point, or to a kink where both cores change their support point; returns nothing if
/// that fails. Heights that differ by `rounding` count as equal.
std::optional<Vec3> climb_smooth(const ConvexCore& a, const ConvexCore& b, const Vec3& from,
                                 const Track& track, double rounding) {
  Vec3 n = track.across(from);
  const double length = n.norm();
  if (!(length > 0.1)) return {};
  n = n / length;
  Vec3 d = b.support(-n) - a.support(n);
  if (!a.curved() && !b.curved()) {  // the nearest points are vertices, or on the edge
    const Vec3 within = track.across(d);
    const double distance = within.norm();
    if (!(within.dot(n) > 0)) return {};
    return track.across(within / distance).normalized();  // projected again, since the remainder may be small
  }
  double moved = std::numeric_limits<double>::infinity();
  for (int i = 0; i < most_steps; ++i) {
    const auto step = newton_step(n, d, a.support_derivative(n) + b.support_derivative(-n), track);
    if (!step) return {};
    const double height = n.dot(d), before = std::exchange(moved, step->squaredNorm());
    const bool is_last = moved < last_step || (moved < small_step && moved > before / 4);
    const auto after = [&](double share) -> Vec3 { return track.across(n + share * *step).normalized(); };
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

/// Keeps the highest direction tried; of equal ones the first.
struct Best {
  const ConvexCore &a, &b;
  double handicap;
  Peak peak{Vec3::Zero(), -std::numeric_limits<double>::infinity()};

  void consider(const Vec3& n) {
    const double gap = core_separation(a, b, n);
    if (gap > peak.core_gap + handicap || peak.normal.isZero(0)) peak = {n, gap};
  }
};

/// Returns the common direction, nearer to n, of two great circles, given by their axes, unless parallel.
std::optional<Vec3> on_both(const Vec3& u, const Vec3& v, const Vec3& n) {
  const Vec3 cross = u.cross(v);
  const double sine = cross.norm();
  if (!(sine > parallel_sine)) return {};
  return cross.dot(n) < 0 ? Vec3(-cross / sine) : Vec3(cross / sine);
}

/// Returns the highest direction that features near n give.
Peak step_up(const ConvexCore& a, const ConvexCore& b, const Vec3& n, double angle, double handicap) {
  thread_local Kinks of_a, of_b;
  of_a.clear();
  of_b.clear();
  a.kinks(n, angle, of_a);
  b.kinks(-n, angle, of_b);
  Best best{a, b, handicap};
  for (const Vec3& face : of_a.faces) best.consider(face);
  for (const Vec3& face : of_b.faces) best.consider(-face);
  for (const Vec3& u : of_a.circles)
    for (const Vec3& v : of_b.circles)
      if (const auto crossing = on_both(u, v, n)) best.consider(*crossing);
  for (const Kinks* kinks : {&of_a, &of_b})
    for (const Vec3& axis : kinks->circles)
      if (const auto on_circle = climb_smooth(a, b, n, {&axis}, handicap)) best.consider(*on_circle);
  if (const auto smooth = climb_smooth(a, b, n, {}, handicap)) best.consider(*smooth);
  return best.peak;
}

}  // namespace

std::optional<Peak> search_directions(const ConvexCore& a, const ConvexCore& b, const Peak& seed,
                                      double enough) {
  return Search(a, b, seed, enough).run();
}

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
