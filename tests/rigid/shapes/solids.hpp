#pragma once
// Convex polyhedra for tests, by their corners and faces.
#include "rigid/shapes/shape.hpp"

namespace silt::rigid::testing {

/// Loops of the faces of a hexahedron with the corners (i, j, k), i first.
inline std::vector<std::vector<int>> hexahedron_faces() {
  return {{0, 4, 6, 2}, {1, 3, 7, 5}, {0, 1, 5, 4}, {2, 6, 7, 3}, {0, 2, 3, 1}, {4, 5, 7, 6}};
}

inline std::vector<Vec3> hexahedron_corners(const Vec3& lower, const Vec3& upper) {
  std::vector<Vec3> corners;
  for (int i = 0; i < 8; ++i)
    corners.push_back(
        {i & 1 ? upper[0] : lower[0], i & 2 ? upper[1] : lower[1], i & 4 ? upper[2] : lower[2]});
  return corners;
}

inline Polyhedron cuboid(const Vec3& lower, const Vec3& upper) {
  return {make_polyhedron_mesh(hexahedron_corners(lower, upper), hexahedron_faces())};
}

/// A frustum with an oblique axis: its top is half as large as its base and shifted aside.
inline Polyhedron frustum() {
  return {make_polyhedron_mesh({{-1, -0.8, -0.6},
                                {1, -0.8, -0.6},
                                {-1, 0.8, -0.6},
                                {1, 0.8, -0.6},
                                {-0.2, -0.1, 0.7},
                                {0.8, -0.1, 0.7},
                                {-0.2, 0.7, 0.7},
                                {0.8, 0.7, 0.7}},
                               hexahedron_faces())};
}

inline Polyhedron tetrahedron(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d) {
  return {make_polyhedron_mesh({a, b, c, d}, {{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {2, 0, 3}})};
}

inline Polyhedron octahedron(const Vec3& half) {
  const Vec3 x(half[0], 0, 0), y(0, half[1], 0), z(0, 0, half[2]);
  return {make_polyhedron_mesh(
      {x, -x, y, -y, z, -z},
      {{0, 2, 4}, {2, 1, 4}, {1, 3, 4}, {3, 0, 4}, {2, 0, 5}, {1, 2, 5}, {3, 1, 5}, {0, 3, 5}})};
}

}  // namespace silt::rigid::testing
