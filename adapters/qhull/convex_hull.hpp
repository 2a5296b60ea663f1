#pragma once
// The convex hull of points, by qhull.
#include <memory>
#include <span>
#include <vector>

#include "rigid/shapes/polyhedron_mesh.hpp"

namespace silt::adapters {

/// Neighbouring faces that are flat to this share of the hull's size are one face, and points closer than
/// this to the hull of the others need not be corners of it: of its largest extent, or, of a hull that is ten
/// times as long as thick or more, of its extent across the face. Single-precision files resolve 1e-7.
inline constexpr double hull_flatness = 1e-6;

struct ConvexHull {
  std::shared_ptr<const rigid::PolyhedronMesh> mesh;
  std::vector<int> corners;  // which of the points the mesh's vertices are, rising
};

/// Points inside the hull or on it, but no corners of it, are left out. A pure function of the points.
/// Throws std::invalid_argument if they are fewer than 4, not finite, or nearly in one plane; what qhull
/// itself has to say is in the message.
ConvexHull convex_hull(std::span<const rigid::Vec3> points);

/// A face of a hull, as qhull has it.
struct HullFace {
  std::vector<int> corners;  // of the points, counter-clockwise seen from outside
  rigid::Vec3 normal;        // outward
};

/// Returns the faces of the hull of points, without a PolyhedronMesh; `flatness` is as above. Throws
/// likewise.
std::vector<HullFace> hull_faces(std::span<const rigid::Vec3> points, double flatness);

}  // namespace silt::adapters
