#pragma once
// A closed surface of triangles out of a file, and a convex body.
#include "adapters/mesh/soup.hpp"
#include "rigid/shapes/polyhedron_mesh.hpp"

namespace silt::adapters {

struct ReadMesh {
  rigid::SharedMesh surface;
  std::size_t triangles = 0;  // of the file
  WeldCounts welded;
  SurfaceCounts closed;
  double coordinate_step = 0;  // between its largest coordinates, if in single precision; times `scale`
};

/// Reads the bytes of an STL, OBJ or PLY file, which of them its name's ending says, every length times
/// `scale`. Corners closer than 5e-7 of its size are one; those that no face uses do not count.
/// std::invalid_argument says what is wrong, with points in the units of the file, and what to do. Memory:
/// about 300 bytes a triangle, whatever a header claims.
ReadMesh read_mesh(std::string_view name, std::string_view bytes, double scale);

struct ReadPolyhedron {
  std::shared_ptr<const rigid::PolyhedronMesh> mesh;
  double coordinate_step = 0;  // as of ReadMesh
};

/// Reads a surface likewise, and requires that it is convex: its volume is that of its hull but for what
/// numbers in single precision leave. Triangles in one plane become one face.
ReadPolyhedron read_polyhedron(std::string_view name, std::string_view bytes, double scale);

}  // namespace silt::adapters
