#pragma once
// The convex shapes as one variant: the only shapes a collision backend handles.
#include <variant>

#include "rigid/shapes/box.hpp"
#include "rigid/shapes/capsule.hpp"
#include "rigid/shapes/cylinder.hpp"
#include "rigid/shapes/ellipsoid.hpp"
#include "rigid/shapes/half_space.hpp"
#include "rigid/shapes/polyhedron.hpp"
#include "rigid/shapes/shape_fwd.hpp"
#include "rigid/shapes/sphere.hpp"

namespace silt::rigid {

template <ConvexSolid... S>
using ConvexShapes = std::variant<S...>;

struct ConvexShape : ConvexShapes<Sphere, Box, Capsule, Cylinder, Ellipsoid, Polyhedron, HalfSpace> {
  using variant::variant;
};

/// Returns the point of the shape furthest along direction_B, a vector of any nonzero length.
Vec3 support(const ConvexShape&, const Vec3& direction_B);
/// Returns the part of the line origin + t direction inside the shape; none if the line misses it.
std::optional<LineInterval> line_interval(const ConvexShape&, const Vec3& origin_B, const Vec3& direction_B);
/// Returns the curvature tensor of the surface at x_B (on the surface, to rounding) with outward unit normal
/// n_B: symmetric, zero along the normal; its other eigenvalues are the principal curvatures, >= 0. None
/// where n_B is not the normal of a face or a side, so at an edge or a corner.
std::optional<Mat3> curvature(const ConvexShape&, const Vec3& x_B, const Vec3& n_B);
/// Returns whether the surface has a curvature everywhere, so neither edges nor corners.
bool is_smooth(const ConvexShape&);

}  // namespace silt::rigid
