#pragma once
// The geometry of a convex polyhedron: made once from its corners and faces, then shared by all who look at
// it.
#include <array>
#include <memory>
#include <vector>

#include "rigid/math/types.hpp"

namespace silt::rigid {

struct PolyhedronMesh {
  struct Face {
    Vec3 normal;               // unit, outward
    double offset;             // normal . x = offset on the face
    std::vector<int> corners;  // of vertices, counter-clockwise seen from outside; any number, coplanar
  };
  struct Edge {
    std::array<int, 2> corners;  // of vertices
    std::array<int, 2> faces;    // the two it parts
  };
  std::vector<Vec3> vertices;
  std::vector<Face> faces;
  std::vector<Edge> edges;
  std::vector<std::vector<int>> neighbours;  // of each vertex, along the edges
};

/// Makes a mesh of corners and the faces' loops of corners (counter-clockwise seen from outside). Every face
/// must be flat and convex and the whole closed and convex, to `flatness` of its size; std::invalid_argument
/// says what is not. Coplanar neighbouring faces must have been merged (adapters/qhull does).
std::shared_ptr<const PolyhedronMesh> make_polyhedron_mesh(std::vector<Vec3> vertices,
                                                           const std::vector<std::vector<int>>& faces,
                                                           double flatness = 1e-9);
std::shared_ptr<const PolyhedronMesh> shifted(const PolyhedronMesh&, const Vec3& by);
std::shared_ptr<const PolyhedronMesh> scaled(const PolyhedronMesh&, double factor);

/// Distance to the surface, negative inside; exact.
double signed_distance(const PolyhedronMesh&, const Vec3& x);

/// Integrals over the solid of 1, d and d d^T with d = x - about: exact, the sum over the tetrahedra between
/// the faces' triangles and one corner (Tonon, J. Math. Stat. 1 (2004)).
struct PolyhedronIntegrals {
  Vec3 about = Vec3::Zero();
  double volume = 0;
  Vec3 first = Vec3::Zero();
  Mat3 second = Mat3::Zero();
};
PolyhedronIntegrals integrals(const PolyhedronMesh&);

}  // namespace silt::rigid
