#pragma once
// The convex hull of points, by qhull.
#include <memory>
#include <span>
#include <vector>

#include "rigid/shapes/polyhedron_mesh.hpp"

namespace silt::adapters {

/// Neighbouring faces that are flat to this share of the hull's size (its largest extent) are one face, and
/// points closer than this to the hull of the others need not be corners of it. Single-precision files
/// resolve 1e-7.
inline constexpr double hull_flatness = 1e-6;

struct ConvexHull {
  std::shared_ptr<const rigid::PolyhedronMesh> mesh;
  std::vector<int> corners;  // which of the points the mesh's vertices are, rising
};

/// Points inside the hull or on it, but no corners of it, are left out. A pure function of the points.
/// Throws std::invalid_argument if they are fewer than 4, not finite, or nearly in one plane; what qhull
/// itself has to say is in the message.
ConvexHull convex_hull(std::span<const rigid::Vec3> points);

}  // namespace silt::adapters
