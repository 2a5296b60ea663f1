#pragma once
// Which triangles of meshes may touch, by the meshes' own trees of boxes.
#include <utility>
#include <vector>

#include "rigid/math/types.hpp"
#include "rigid/shapes/triangle_mesh.hpp"

namespace silt::rigid {

using TrianglePair = std::pair<std::uint32_t, std::uint32_t>;

/// Appends those of the mesh whose boxes overlap `near` (frame of the mesh), and perhaps some near it.
void append_triangles_near(const TriangleMesh&, const BoundingBox& near, std::vector<std::uint32_t>& out);

/// Appends those of a and b that may be nearer to each other than `margin` (lattice units), and perhaps more.
void append_triangle_pairs_near(const TriangleMesh& a, const Pose& pose_a, const TriangleMesh& b,
                                const Pose& pose_b, double margin, std::vector<TrianglePair>& out);

}  // namespace silt::rigid
