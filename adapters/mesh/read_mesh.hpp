#pragma once
// A closed surface of triangles out of a file.
#include <memory>
#include <string_view>

#include "adapters/mesh/closed_surface.hpp"
#include "adapters/mesh/welded.hpp"
#include "rigid/shapes/triangle_mesh.hpp"

namespace silt::adapters {

struct ReadMesh {
  std::shared_ptr<const rigid::TriangleMesh> surface;
  std::size_t triangles = 0;  // of the file
  WeldCounts welded;
  SurfaceCounts closed;
  double coordinate_step =
      0;  // between its largest coordinates, if they are in single precision; times `scale`
};

/// Reads the bytes of an STL, OBJ or PLY file, which of them its name's ending says, every length times
/// `scale`. Corners closer than 5e-7 of its size are one; those that no face uses do not count.
/// std::invalid_argument says what is wrong, with points in the units of the file, and what to do. Memory:
/// about 300 bytes a triangle, whatever a header claims.
ReadMesh read_mesh(std::string_view name, std::string_view bytes, double scale);

}  // namespace silt::adapters
