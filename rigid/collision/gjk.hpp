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

/// From n uphill in the separation of the cores, overlapping or not: b is moved off along n and the nearest
/// direction taken for n, until it stays. That is the proximal-point method: every round finds the largest
/// s(m) + t m.n.
Vec3 walk_uphill(const ConvexCore& a, const ConvexCore& b, const Vec3& n);

}  // namespace silt::rigid
