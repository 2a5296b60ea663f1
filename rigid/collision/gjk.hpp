#pragma once
// The direction in which two cores that do not touch are nearest (Gilbert, Johnson, Keerthi, IEEE J. Robotics
// Automation 4 (1988) 193).
#include <optional>

#include "rigid/collision/convex_core.hpp"

namespace silt::rigid {

/// Unit, from a to b moved by `shift` (lattice units), good to some 1e-4 radian; `start` is any unit vector,
/// the nearer to the answer the sooner done. Nothing where the cores overlap or are apart by less than 1e-9
/// of their size.
std::optional<Vec3> gjk_direction(const ConvexCore& a, const ConvexCore& b, const Vec3& shift,
                                  const Vec3& start);

/// The hull of a core at two poses.
struct SweptCore {
  const ConvexCore &before, &after;
  Vec3 support(const Vec3& n) const {
    const Vec3 x = before.support(n), y = after.support(n);
    return n.dot(x) >= n.dot(y) ? x : y;
  }
};
/// A core made smaller about a point inside it: what it touches is then apart from it.
struct ShrunkCore {
  const ConvexCore& core;
  Vec3 middle;
  double by;  // part of its size
  Vec3 support(const Vec3& n) const { return (1 - by) * core.support(n) + by * middle; }
};
/// As above; `size` (lattice units) is what rounding is relative to.
std::optional<Vec3> gjk_direction(const SweptCore& a, const ShrunkCore& b, const Vec3& start, double size);

/// From n uphill in the separation of the cores, overlapping or not: b is moved off along n and the nearest
/// direction taken for n, until it stays. That is the proximal-point method: every round finds the largest
/// s(m) + t m.n.
Vec3 walk_uphill(const ConvexCore& a, const ConvexCore& b, const Vec3& n);

}  // namespace silt::rigid
