#pragma once
// Where a convex body touches the inside of a tube, in closed form or to rounding. A tube is not convex, so
// this is no business of a collision backend: the gap is the tube's radius less the largest distance of the
// body's points from the axis, a convex function, so the points looked for are extreme ones of the body.
#include <vector>

#include "rigid/bodies/contact.hpp"
#include "rigid/shapes/shape_fwd.hpp"

namespace silt::rigid {

/// Appends, ordered by feature, every contact with a gap up to `tolerance` (lattice units) at a point that is
/// furthest from the axis among those of the body near it: the one of a sphere, the balls at both ends of a
/// capsule, the corners of a box or polyhedron, up to two points of each rim of a cylinder, up to two of an
/// ellipsoid. The normal points from the body into the wall. A point on the axis has the normal along the
/// tube's x axis.
void append_tube_contacts(const ConvexShape& body, const Pose& pose, const Tube& tube,
                          const Pose& pose_of_tube, double tolerance, std::vector<ContactPoint>& out);

/// Returns the least gap of all parts of a shape; negative where it reaches into the wall.
double gap_in_tube(const Shape&, const Pose&, const Tube&, const Pose& pose_of_tube);

}  // namespace silt::rigid
