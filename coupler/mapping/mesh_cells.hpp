#pragma once
// The cells inside a mesh.
#include "coupler/mapping/bit_window.hpp"
#include "coupler/mapping/placed_mesh.hpp"
#include "rigid/shapes/mesh.hpp"

namespace silt::coupler {

/// Sets the bits of the cells whose centres are in the solid, all but two at either end of the window; `low`:
/// cell of its bit 0 in the coordinates of the mesh's image. A row changes sides wherever it crosses a
/// triangle, in whatever order these come.
void mark_mesh(const rigid::Mesh&, PlacedMesh&, lbm::Int3 low, BitWindow&);

}  // namespace silt::coupler
