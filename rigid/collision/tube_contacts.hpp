#pragma once
// A convex body touches the wall of a tube from inside. A tube is not convex, so this is no business of a
// collision backend: the gap is least at extreme points of the body, whose distance from the axis, a convex
// function, is largest. They are known in closed form, or to rounding.
#include <vector>

#include "rigid/bodies/contact.hpp"
#include "rigid/shapes/shape_fwd.hpp"

namespace silt::rigid {

/// Appends, ordered by feature, every contact with a gap up to `tolerance` (lattice units) at a point that is
/// nearest to the wall among those of the body near it: the one of a sphere, the balls at both ends of a
/// capsule, the corners of a box or polyhedron, up to two points of each rim of a cylinder, up to two of an
/// ellipsoid. The normal points from the body into the wall.
void append_tube_contacts(const ConvexShape& body, const Pose& pose, const Tube&, const Pose& pose_of_tube,
                          double tolerance, std::vector<ContactPoint>& out);

/// Returns the least gap of all parts of a shape; negative where it reaches into the wall.
double gap_in_tube(const Shape&, const Pose&, const Tube&, const Pose& pose_of_tube);

}  // namespace silt::rigid
