#pragma once
// From the direction of a contact of any two convex cores to its points.
#include "rigid/bodies/contact.hpp"
#include "rigid/collision/common_point.hpp"
#include "rigid/collision/convex_core.hpp"

namespace silt::rigid {

/// As append_manifold, for cores of any kind: where faces look at each other (ConvexCore::facing_outline) the
/// corners of their common patch, a cylinder's end standing as the octagon of its rim points; where a line
/// (of a capsule, of a cylinder's side) lies over a face the ends of its part over it; where two lines are
/// nearly parallel the ends of their common length. `deepest` is where the cores meet along the normal; it is
/// added where none of the others is as deep.
void append_convex_manifold(const ConvexCore& a, const ConvexCore& b, const Vec3& normal, double core_gap,
                            const CommonPoint& deepest, double tolerance, std::vector<ContactPoint>& out);

/// Appends those of the core's plane_points that are within `tolerance` of the plane through `origin` with
/// unit `outward` normal: the vertices of a polyhedron, the rim points of a disc that lies flat, else the
/// lowest of its rim, the lowest point of an ellipsoid.
void append_convex_plane_manifold(const ConvexCore& a, const Vec3& origin, const Vec3& outward,
                                  double tolerance, std::vector<ContactPoint>& out);

}  // namespace silt::rigid
