#pragma once
// Closed triangle meshes of the bodies' surfaces, for pictures. They are made from the support function
// alone, so a new convex shape needs no line here.
#include "adapters/hdf5/body_series.hpp"
#include "rigid/shapes/shape.hpp"

namespace silt {

/// Returns the mesh of a part's surface in the frame of its body, lengths times `unit`. Corners, edges and
/// flat faces are kept; a polyhedron's faces are cut into triangles; no curved surface lies further from its
/// triangles than `tessellation_tolerance` of the half width there. The mesh lies inside the surface.
/// std::invalid_argument for a part without end (a half-space).
adapters::TriangleMesh tessellation(const rigid::Part&, double unit);

/// Returns the triangles of a mesh as they are, each with its own normal, lengths times `unit`.
adapters::TriangleMesh tessellation(const rigid::TriangleMesh&, double unit);

/// Distance between a curved surface and its mesh, relative to half the shape's width along the normal or, if
/// that is less, to the middle one of its three half extents.
inline constexpr double tessellation_tolerance = 0.006;

}  // namespace silt
