#pragma once
// Whether a depth at which two overlapping cores can part is the least, told from where they meet alone.
#include "rigid/collision/common_point.hpp"
#include "rigid/collision/convex_core.hpp"

namespace silt::rigid {

/// Whether no direction has a larger separation than unit n, along which it is -depth (lattice units, > 0),
/// the cores meeting at `where`. Sufficient, not necessary: that the difference b - a contains the ball of
/// radius `depth` about the origin, which follows where it contains
/// - the ball that touches its boundary at the foot of the normal, of a radius at least as large: the sum of
///   the cores' own (touching_ball); or
/// - for edges that cross, the disc of radius f about the foot within the face they span, which covers the
///   directions up to 2 atan(f / depth) from the normal, and a ball about the difference of the centres that
///   covers the others.
bool is_least_depth(const ConvexCore& a, const ConvexCore& b, const Vec3& n, double depth,
                    const CommonPoint& where);

}  // namespace silt::rigid
