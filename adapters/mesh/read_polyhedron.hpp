#pragma once
// A convex body out of a file of triangles.
#include <memory>
#include <string_view>

#include "rigid/shapes/polyhedron_mesh.hpp"

namespace silt::adapters {

struct ReadPolyhedron {
  std::shared_ptr<const rigid::PolyhedronMesh> mesh;
  double coordinate_step = 0;  // as of ReadMesh
};

/// Reads a surface as read_mesh does, and requires that it is convex: its volume is that of its hull but
/// for what numbers in single precision leave. Triangles in one plane become one face. std::invalid_argument
/// says what is wrong, with points in the units of the file, and what to do.
ReadPolyhedron read_polyhedron(std::string_view name, std::string_view bytes, double scale);

}  // namespace silt::adapters
