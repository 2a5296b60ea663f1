#pragma once
// Nearest and furthest points of an ellipsoid about its own axes: one secular equation serves both.
#include "rigid/math/types.hpp"

namespace silt::rigid {

/// x inside or on the surface.
bool in_ellipsoid(const Vec3& half_axes, const Vec3& x);
/// The point of the surface nearest to x (one of them where several are), inside and outside. Source: D.
/// Eberly, "Distance from a Point to an Ellipse, an Ellipsoid, or a Hyperellipsoid" (2013), the reduction to
/// one root; the root not by his bisection but as in trust-region steps (More and Sorensen, SIAM J. Sci.
/// Stat. Comput. 4 (1983)).
Vec3 nearest_on_ellipsoid(const Vec3& half_axes, const Vec3& x);
/// Distance to the surface, negative inside. Error below 1e-14 of the largest axis plus 1e-14 of the
/// distance, for axes of any ratio; its sign agrees with in_ellipsoid.
double ellipsoid_distance(const Vec3& half_axes, const Vec3& x);
/// Distance from x to the point of the surface furthest from it.
double ellipsoid_reach(const Vec3& half_axes, const Vec3& x);

}  // namespace silt::rigid
