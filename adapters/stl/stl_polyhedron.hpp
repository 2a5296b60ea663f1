#pragma once
// A convex body out of an STL file.
#include <memory>
#include <string_view>

#include "rigid/shapes/polyhedron_mesh.hpp"

namespace silt::adapters {

/// Reads the bytes of a file, text or binary, every length times `scale`. Corners closer than hull_flatness
/// of its size are one; triangles in one plane become one face. The surface must be closed (each edge between
/// two triangles that run along it in opposite ways) and convex: its volume that of its hull to 1e-6. All its
/// triangles may be inside out. std::invalid_argument says what is wrong, with points in the units of the
/// file, and what to do.
std::shared_ptr<const rigid::PolyhedronMesh> stl_polyhedron(std::string_view bytes, double scale);

}  // namespace silt::adapters
