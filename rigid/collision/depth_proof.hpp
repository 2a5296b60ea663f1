#pragma once
// Whether a depth at which two overlapping cores can part is the least, told from where they meet alone.
#include "rigid/collision/common_point.hpp"
#include "rigid/collision/convex_core.hpp"

namespace silt::rigid {

/// Whether no direction has a larger separation than unit n, along which it is -depth (lattice units, > 0),
/// the cores meeting at `where`. Sufficient, not necessary: that the difference b - a contains the ball of
/// radius `depth` about the origin, which it does where it reaches as far in every direction m. With p the
/// foot of the normal and t the part of m across n:
/// - m within 90 degrees of n: a ball of radius r within a core that touches its boundary at p reaches
///   r (1 - m.n) further along m than p; a disc of radius r with p on its rim, whose tangent is f, at least
///   r (t.f)^2 / 2; a line through p along u that goes on for l to both sides l |t.u| >= l (t.u)^2. Those of
///   the two cores add up, and t^2 >= 1 - m.n. So it is enough that the sum of what they are of the squares
///   of a unit t is nowhere below the depth.
/// - m beyond: balls inside of the cores, near where they meet, reach as far.
bool is_least_depth(const ConvexCore& a, const ConvexCore& b, const Vec3& n, double depth,
                    const CommonPoint& where);

}  // namespace silt::rigid
