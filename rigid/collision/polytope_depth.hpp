#pragma once
// The least depth of two solid polytopes that overlap, from all faces of their difference.
#include "rigid/collision/climb.hpp"

namespace silt::rigid {

/// Whether both are boxes or polyhedra with volume, and have so few edges that to look at all pairs of them
/// takes less time than a search over directions.
bool has_few_edges(const ConvexCore& a, const ConvexCore& b);

/// The largest separation of two such cores that overlap, exact to rounding: the difference b - a is a
/// polytope, whose faces are normal to a face of either or span an edge of each, and the origin in it is
/// least deep below one of them. Two edges span a face if the arcs of directions in which they support their
/// core cross (of a, and of b turned round: the Gauss map; Gregorius, "The separating axis test between
/// convex polyhedra", GDC 2013). Of equal ones faces of a, then of b, come first.
Peak least_depth(const ConvexCore& a, const ConvexCore& b);

}  // namespace silt::rigid
