#include "tests/adapters/pair_scenes.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

namespace silt::tests {

namespace {

using std::numbers::pi;

/// Returns the kinks that the shape's row tells of, in the world frame.
rigid::Kinks kinks_of(const ConvexShape& shape, const Pose& pose) {
  rigid::Kinks kinks;
  row_of(rigid::shape_name(shape)).kinks(shape, kinks);
  for (Vec3& axis : kinks.circles) axis = pose.orientation * axis;
  for (Vec3& face : kinks.faces) face = pose.orientation * face;
  return kinks;
}

class Gap {
 public:
  explicit Gap(const Pair& p) : p_(p), turn_a_(p.pose_a.orientation), turn_b_(p.pose_b.orientation) {
    d_ = p.pose_b.position - p.pose_a.position;
  }

  double at(const Vec3& n) const {
    return n.dot(d_) - n.dot(turn_a_ * rigid::support(p_.a, turn_a_.transpose() * n)) +
           n.dot(turn_b_ * rigid::support(p_.b, turn_b_.transpose() * -n));
  }
  void take(const Vec3& n) {
    if (const double gap = at(n); gap > best.gap) best = {gap, n};
  }
  void take_both(const Vec3& axis) { take(axis), take(-axis); }

  /// The two directions normal to both axes.
  void take_crossings(const Vec3& u, const Vec3& v) {
    const Vec3 cross = u.cross(v);
    if (cross.norm() > 1e-9) take_both(cross.normalized());
  }

  void on_circle(const Vec3& axis) {
    constexpr int samples = 120;
    const Vec3 u = axis.unitOrthogonal(), v = axis.cross(u);
    auto direction = [&](double t) { return Vec3(std::cos(t) * u + std::sin(t) * v); };
    std::array<double, samples> gap;
    for (int i = 0; i < samples; ++i) gap[i] = at(direction(2 * pi * i / samples));
    std::vector<std::pair<double, int>> peaks;
    for (int i = 0; i < samples; ++i)
      if (gap[i] >= gap[(i + samples - 1) % samples] && gap[i] >= gap[(i + 1) % samples])
        peaks.push_back({-gap[i], i});
    std::sort(peaks.begin(), peaks.end());
    for (std::size_t k = 0; k < std::min<std::size_t>(3, peaks.size()); ++k) {
      double low = 2 * pi * (peaks[k].second - 1) / samples, high = 2 * pi * (peaks[k].second + 1) / samples;
      if (-peaks[k].first < best.gap - 4) continue;  // would have to rise by more than it can
      const double golden = (std::sqrt(5.0) - 1) / 2;
      double x = high - golden * (high - low), y = low + golden * (high - low);
      double f = at(direction(x)), g = at(direction(y));
      for (int i = 0; i < 70; ++i) {
        if (f > g)
          high = y, y = x, g = f, x = high - golden * (high - low), f = at(direction(x));
        else
          low = x, x = y, f = g, y = low + golden * (high - low), g = at(direction(y));
      }
      take(direction((low + high) / 2));
    }
  }

  void over_the_sphere() {
    constexpr int samples = 1500, refined = 5;
    std::vector<std::pair<double, Vec3>> grid;
    for (int i = 0; i < samples; ++i) {  // a spiral of equal areas
      const double z = 1 - (2 * i + 1.0) / samples, r = std::sqrt(1 - z * z),
                   t = i * pi * (3 - std::sqrt(5.0));
      const Vec3 n(r * std::cos(t), r * std::sin(t), z);
      grid.push_back({-at(n), n});
    }
    grid.push_back({-at(d_.normalized()), d_.normalized()});
    std::stable_sort(grid.begin(), grid.end(),
                     [](const auto& x, const auto& y) { return x.first < y.first; });
    std::vector<Vec3> starts;
    for (const auto& [gap, n] : grid) {
      if (starts.size() == refined) break;
      if (std::all_of(starts.begin(), starts.end(),
                      [&, &n = n](const Vec3& s) { return (s - n).norm() > 0.15; }))
        starts.push_back(n);
    }
    for (const Vec3& n : starts) uphill(n);
  }

  ReferenceGap best{-std::numeric_limits<double>::infinity(), Vec3::Zero()};

 private:
  /// Nelder and Mead (Computer Journal 7 (1965) 308) in the plane that touches the sphere at n, twice.
  void uphill(Vec3 n) {
    for (double size : {0.05, 1e-4}) {
      const Vec3 u = n.unitOrthogonal(), v = n.cross(u);
      struct Point {
        double x, y, gap;
      };
      auto direction = [&](double x, double y) { return Vec3((n + x * u + y * v).normalized()); };
      auto point = [&](double x, double y) { return Point{x, y, at(direction(x, y))}; };
      std::array<Point, 3> s{point(0, 0), point(size, 0), point(0, size)};
      for (int i = 0; i < 150; ++i) {
        std::sort(s.begin(), s.end(), [](const Point& p, const Point& q) { return p.gap > q.gap; });
        const double x = (s[0].x + s[1].x) / 2, y = (s[0].y + s[1].y) / 2;
        auto along = [&](double t) { return point(x + t * (s[2].x - x), y + t * (s[2].y - y)); };
        const Point reflected = along(-1);
        if (reflected.gap > s[0].gap) {
          const Point further = along(-2);
          s[2] = further.gap > reflected.gap ? further : reflected;
        } else if (reflected.gap > s[1].gap) {
          s[2] = reflected;
        } else if (const Point inner = along(reflected.gap > s[2].gap ? -0.5 : 0.5); inner.gap > s[2].gap) {
          s[2] = inner;
        } else {
          for (int k = 1; k < 3; ++k) s[k] = point((s[0].x + s[k].x) / 2, (s[0].y + s[k].y) / 2);
        }
      }
      std::sort(s.begin(), s.end(), [](const Point& p, const Point& q) { return p.gap > q.gap; });
      n = direction(s[0].x, s[0].y);
    }
    take(n);
  }

  const Pair& p_;
  Mat3 turn_a_, turn_b_;
  Vec3 d_;
};

}  // namespace

ReferenceGap search_gap(const Pair& p) {
  if (const auto* wall = std::get_if<rigid::HalfSpace>(&p.b)) {
    const Vec3 outward = p.pose_b.orientation * wall->normal;
    const Vec3 lowest = p.pose_a.to_world(rigid::support(p.a, p.pose_a.orientation.conjugate() * -outward));
    return {outward.dot(lowest - p.pose_b.position), -outward};
  }
  Gap gap(p);
  rigid::Kinks a = kinks_of(p.a, p.pose_a), b = kinks_of(p.b, p.pose_b);
  for (const rigid::Kinks* kinks : {&a, &b})
    for (const Vec3& n : kinks->faces) gap.take_both(n);
  for (const Vec3& u : a.circles)
    for (const Vec3& v : b.circles) gap.take_crossings(u, v);
  gap.over_the_sphere();
  for (const rigid::Kinks* kinks : {&a, &b})
    for (const Vec3& axis : kinks->circles) gap.on_circle(axis);
  return gap.best;
}

}  // namespace silt::tests
