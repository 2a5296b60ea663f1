#pragma once
// How a body's surface bends: what the width of the gap to another one depends on.
#include <optional>

#include "rigid/shapes/shape.hpp"

namespace silt::rigid {

/// Curvature tensor of a convex surface at x_B (on it, to rounding) with outward unit normal n_B: symmetric,
/// zero along the normal, eigenvalues across it the principal curvatures, >= 0. None where the shape may be
/// flat or have an edge (box, cylinder, polyhedron). A half-space has zero curvature.
std::optional<Mat3> curvature(const ConvexShape&, const Vec3& x_B, const Vec3& n_B);
/// Has it one everywhere?
bool is_smooth(const ConvexShape&);

}  // namespace silt::rigid
