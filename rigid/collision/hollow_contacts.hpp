#pragma once
// A convex body touches the wall of a hollow from inside. A hollow is not convex, so this is no business of a
// collision backend: the gap is least at extreme points of the body. In a tube they are known in closed form,
// or to rounding, as points whose distance from the axis, a convex function, is largest; in another hollow
// those of balls are known, and others are searched.
#include <vector>

#include "rigid/bodies/contact.hpp"
#include "rigid/shapes/shape_fwd.hpp"

namespace silt::rigid {

/// Appends, ordered by feature, every contact with a gap up to `tolerance` (lattice units) at a point that is
/// nearest to the wall among those of the body near it: the one of a sphere, the balls at both ends of a
/// capsule, the corners of a box or polyhedron, up to two points of each rim of a cylinder, up to two of an
/// ellipsoid. The normal points from the body into the wall.
void append_hollow_contacts(const ConvexShape& body, const Pose& pose, const HollowShape&,
                            const Pose& pose_of_hollow, double tolerance, std::vector<ContactPoint>& out);

/// Returns the least gap of all parts of a shape; negative where it reaches into the wall.
double gap_in_hollow(const Shape&, const Pose&, const HollowShape&, const Pose& pose_of_hollow);

}  // namespace silt::rigid
