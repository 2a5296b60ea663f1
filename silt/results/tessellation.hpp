#pragma once
// Makes closed triangle meshes of bodies for pictures, from the support functions of their shapes.
#include "adapters/hdf5/body_series.hpp"
#include "rigid/shapes/shape.hpp"

namespace silt {

/// Returns the mesh of a part's surface in the frame of its body, lengths times `unit`. It lies inside the
/// surface, with a gap below `tessellation_tolerance` times the local half width; corners, edges and flat
/// faces are exact; faces of polyhedra are cut into triangles. Throws std::invalid_argument for an unbounded
/// part (a half-space).
adapters::TriangleMesh tessellation(const rigid::Part&, double unit);

/// Returns the triangles of a mesh, each with its own normal, lengths times `unit`.
adapters::TriangleMesh tessellation(const rigid::TriangleMesh&, double unit);

/// Largest gap between a curved surface and its mesh, relative to half the shape's width along the normal or,
/// if smaller, to the middle one of its half extents.
inline constexpr double tessellation_tolerance = 0.006;

}  // namespace silt
