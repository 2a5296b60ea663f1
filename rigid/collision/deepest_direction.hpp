#pragma once
// Gap and normal of any two convex cores.
#include <optional>

#include "rigid/collision/climb.hpp"
#include "rigid/collision/common_point.hpp"

namespace silt::rigid {

/// A direction in which two cores are nearest or least deep in each other, and where they meet.
struct Approach {
  Peak peak;
  CommonPoint where;
};

/// Nothing where the cores are found to be more than `reach` (lattice units) apart. With a curved core, and
/// no polyhedron of many corners, climb() is tried at once, from the direction between the centres or, with
/// an ellipsoid, from the normal to the plane that would part two ellipsoids of these widths; else, and where
/// that has no proof, GJK for cores that are apart, and walk_uphill() for those that overlap, both from the
/// direction between the centres, lead to where proven_direction() starts. Polytopes that overlap have their
/// least depth by least_depth(), if they have few edges.
std::optional<Approach> deepest_direction(const ConvexCore& a, const ConvexCore& b, double reach);

/// The same from unit n. climb() from there; where both cores have a point on the normal that it found, the
/// direction is one of nearest approach. It is the only one if the cores are apart: then the separation is a
/// concave function of the direction. It is the best one of cores that overlap if is_least_depth() says so;
/// else least_depth() or search_directions() tells.
std::optional<Approach> proven_direction(const ConvexCore& a, const ConvexCore& b, const Vec3& n,
                                         double reach);

/// The direction between the centres; the same one every time for cores with one centre.
Vec3 between_centres(const ConvexCore& a, const ConvexCore& b);

}  // namespace silt::rigid
