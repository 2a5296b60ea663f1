#pragma once
// From a direction uphill to the nearest one in which two cores are furthest apart.
#include "rigid/collision/convex_core.hpp"

namespace silt::rigid {

struct Peak {
  Vec3 normal;      // unit, from a to b
  double core_gap;  // core_separation along it
};

/// How often climb() tries the features near by, unless told otherwise.
inline constexpr int climb_rounds = 12;

/// Returns a local maximum of core_separation(n) near unit n: never lower than at n by more than rounding,
/// exact to rounding where it gets there, which it does from anywhere near. Along a smooth piece of both
/// boundaries Newton's method on the sphere: with the supports' difference D(n) and K = -dD/dn the step in
/// the tangent plane T solves (T'KT + n.D) x = T'D. Where n stays where the supporting feature changes (an
/// edge of either core stays normal to n) the same on that circle; two circles, or a face, leave one
/// direction. All of these within `angle` (radian) of n are tried and the highest kept, until nothing rises,
/// at most so many times: the first finds it where no other features come up on the way.
Peak climb(const ConvexCore& a, const ConvexCore& b, const Vec3& n, double angle,
           int most_rounds = climb_rounds);

}  // namespace silt::rigid
