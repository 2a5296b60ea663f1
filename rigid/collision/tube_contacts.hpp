#pragma once
// Contacts of convex bodies inside a tube. A tube is not convex, so collision backends do not handle it. The
// distance from the axis is a convex function, so the gap is least at extreme points of the body.
#include <vector>

#include "rigid/bodies/contact.hpp"
#include "rigid/shapes/shape_fwd.hpp"

namespace silt::rigid {

/// Appends, by feature, the contacts with a gap up to `tolerance` (lattice units) at points where the gap has
/// a local minimum: one for a sphere, both end balls of a capsule, the vertices of a box or polyhedron, up to
/// two points on each rim of a cylinder, up to two on an ellipsoid. Normals point into the wall.
void append_tube_contacts(const ConvexShape& body, const Pose& pose, const Tube&, const Pose& pose_of_tube,
                          double tolerance, std::vector<ContactPoint>& out);

/// Returns the least gap of all parts of a shape; negative if it reaches into the wall.
double gap_in_tube(const Shape&, const Pose&, const Tube&, const Pose& pose_of_tube);

}  // namespace silt::rigid
