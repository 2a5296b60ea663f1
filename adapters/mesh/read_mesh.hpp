#pragma once
// Reads a closed triangle mesh, or a convex polyhedron, from a file.
#include "adapters/mesh/soup.hpp"
#include "rigid/shapes/polyhedron_mesh.hpp"

namespace silt::adapters {

struct ReadMesh {
  rigid::SharedMesh surface;
  std::size_t triangles = 0;  // in the file
  WeldCounts welded;
  SurfaceCounts closed;
  double coordinate_step = 0;  // spacing of its largest coordinates in single precision, times `scale`
};

/// Reads an STL, OBJ or PLY file, by the ending of `name`, and multiplies lengths by `scale`. Vertices
/// closer than 5e-7 of the size are merged, unused ones dropped. Throws std::invalid_argument with the fault,
/// points in the file's units, and a remedy. Needs about 300 bytes per triangle, whatever a header claims.
ReadMesh read_mesh(std::string_view name, std::string_view bytes, double scale);

struct ReadPolyhedron {
  std::shared_ptr<const rigid::PolyhedronMesh> mesh;
  double coordinate_step = 0;  // as in ReadMesh
};

/// Reads a convex surface: its volume must be that of its hull, to the rounding of single precision. Coplanar
/// triangles become one face. Errors as above.
ReadPolyhedron read_polyhedron(std::string_view name, std::string_view bytes, double scale);

}  // namespace silt::adapters
