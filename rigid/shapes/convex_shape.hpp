#pragma once
// The convex shapes, in one piece: a collision backend sees only these.
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

/// The point of a convex shape furthest along direction_B, of any length.
Vec3 support(const ConvexShape&, const Vec3& direction_B);
/// The part of the line origin + t direction inside the shape; none if the line misses it.
std::optional<LineInterval> line_interval(const ConvexShape&, const Vec3& origin_B, const Vec3& direction_B);
/// Curvature tensor of the surface at x_B (on it, to rounding) with outward unit normal n_B: symmetric, zero
/// along the normal, eigenvalues across it the principal curvatures, >= 0; zero on a flat face. None at an
/// edge or a corner: where the normal is not that of a face or a side.
std::optional<Mat3> curvature(const ConvexShape&, const Vec3& x_B, const Vec3& n_B);
/// Says whether the surface has a curvature everywhere: neither edges nor corners.
bool is_smooth(const ConvexShape&);

}  // namespace silt::rigid
