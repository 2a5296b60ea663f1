#pragma once
// The geometry of a convex polyhedron, computed once from vertices and faces and then shared.
#include <array>
#include <memory>
#include <vector>

#include "rigid/math/types.hpp"

namespace silt::rigid {

struct PolyhedronMesh {
  struct Face {
    Vec3 normal;               // unit, outward
    double offset;             // normal . x = offset on the face
    std::vector<int> corners;  // vertex numbers, counter-clockwise seen from outside; coplanar
  };
  struct Edge {
    std::array<int, 2> corners;  // vertex numbers
    std::array<int, 2> faces;    // the two faces that meet at the edge
  };
  std::vector<Vec3> vertices;
  std::vector<Face> faces;
  std::vector<Edge> edges;
  std::vector<std::vector<int>> neighbours;  // of each vertex, along the edges
};

/// Makes a mesh from vertices and, for each face, its loop of vertex numbers (counter-clockwise seen from
/// outside). Throws std::invalid_argument unless every face is flat and convex and the solid closed and
/// convex, to `flatness` times its size. Coplanar neighbours must be merged (adapters/qhull).
std::shared_ptr<const PolyhedronMesh> make_polyhedron_mesh(std::vector<Vec3> vertices,
                                                           const std::vector<std::vector<int>>& faces,
                                                           double flatness = 1e-9);
std::shared_ptr<const PolyhedronMesh> shifted(const PolyhedronMesh&, const Vec3& by);
std::shared_ptr<const PolyhedronMesh> scaled(const PolyhedronMesh&, double factor);

/// Returns the exact distance to the surface, negative inside.
double signed_distance(const PolyhedronMesh&, const Vec3& x);

/// Integrals of 1, d and d d^T with d = x - about over the solid: exact sums over the tetrahedra between the
/// faces' triangles and one vertex (Tonon, J. Math. Stat. 1 (2004)).
struct PolyhedronIntegrals {
  Vec3 about = Vec3::Zero();
  double volume = 0;
  Vec3 first = Vec3::Zero();
  Mat3 second = Mat3::Zero();
};
PolyhedronIntegrals integrals(const PolyhedronMesh&);

}  // namespace silt::rigid
