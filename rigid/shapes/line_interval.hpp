#pragma once
// Where a straight line o + t d is inside a convex shape: one interval of t, in closed form, exact for lines
// from afar and for grazing ones; and the pieces that shapes put theirs together from. (Object mapping asks
// about vectors of lines from close by: coupler/mapping/surface_primitives.hpp. Each is tested against the
// other.)
#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "rigid/math/types.hpp"

namespace silt::rigid {

struct LineInterval {
  double enter, leave;  // parameters along the line, enter <= leave; may be infinite

  static LineInterval everything() {
    constexpr double infinity = std::numeric_limits<double>::infinity();
    return {-infinity, infinity};
  }
};

/// Where a t^2 + 2 b t + c <= 0, for a > 0: its real roots, without cancellation.
inline std::optional<LineInterval> between_roots(double a, double b, double c) {
  const double discriminant = b * b - a * c;
  if (discriminant < 0) return {};
  const double s = std::sqrt(discriminant);
  const double q = b >= 0 ? -b - s : -b + s;
  const double t1 = q / a, t2 = q != 0 ? c / q : 0.0;
  return LineInterval{std::min(t1, t2), std::max(t1, t2)};
}

/// Where |o + t d| <= half_width along one axis.
inline std::optional<LineInterval> in_slab(double o, double d, double half_width) {
  using Interval = std::optional<LineInterval>;
  if (d == 0) return std::abs(o) <= half_width ? Interval{LineInterval::everything()} : Interval{};
  const double t1 = (-half_width - o) / d, t2 = (half_width - o) / d;
  return LineInterval{std::min(t1, t2), std::max(t1, t2)};
}

inline std::optional<LineInterval> in_both(const std::optional<LineInterval>& a,
                                           const std::optional<LineInterval>& b) {
  if (!a || !b) return {};
  const LineInterval i{std::max(a->enter, b->enter), std::min(a->leave, b->leave)};
  return i.enter <= i.leave ? std::optional{i} : std::nullopt;
}

/// In the ball about the origin.
inline std::optional<LineInterval> in_ball(double radius, const Vec3& o, const Vec3& d) {
  const double distance = o.norm();  // the difference of squares, factored: exact close to the surface
  return between_roots(d.squaredNorm(), o.dot(d), (distance - radius) * (distance + radius));
}

}  // namespace silt::rigid
