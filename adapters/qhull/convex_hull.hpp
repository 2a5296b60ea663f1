#pragma once
// Convex hulls of points by qhull.
#include <memory>
#include <span>
#include <vector>

#include "rigid/shapes/polyhedron_mesh.hpp"

namespace silt::adapters {

/// Neighbouring faces that are coplanar to this tolerance are merged, and points closer to the hull of the
/// others may be dropped. It is relative to the largest extent or, for a hull at least ten times as long as
/// thick, to the extent across the face. Single precision resolves 1e-7.
inline constexpr double hull_flatness = 1e-6;

struct ConvexHull {
  std::shared_ptr<const rigid::PolyhedronMesh> mesh;
  std::vector<int> corners;  // indices of the points that are the mesh's vertices, ascending
};

/// Returns the hull without points inside it or on its faces. Throws std::invalid_argument, with qhull's
/// message, for less than 4 points, non-finite ones, or nearly coplanar ones.
ConvexHull convex_hull(std::span<const rigid::Vec3> points);

/// A face of a hull as qhull gives it.
struct HullFace {
  std::vector<int> corners;  // indices of points, counter-clockwise seen from outside
  rigid::Vec3 normal;        // outward
};

/// Returns the faces of the hull without making a PolyhedronMesh; `flatness` and errors as above.
std::vector<HullFace> hull_faces(std::span<const rigid::Vec3> points, double flatness);

}  // namespace silt::adapters
