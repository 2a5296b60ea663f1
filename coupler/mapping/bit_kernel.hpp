#pragma once
// The kernels of object mapping, built once per instruction set: bits of bodies and links, lists of links.
#include <cstdint>

#include "coupler/mapping/bit_window.hpp"
#include "coupler/mapping/cell_bits.hpp"
#include "cpu/isa.hpp"
#include "rigid/shapes/surface_kinds.hpp"

namespace silt::coupler {

/// The reference point of a body relative to a frame.
struct PointInFrame {
  double x, y, z;  // bitwise equal in all frames
  lbm::Int3 low;   // cell of the frame's bit 0, in the coordinates of the point
};

/// The bit streams of one frame from which the links of a surface are listed.
struct LinkBits {
  const std::uint64_t* body;   // cells of the surface, with margins
  const std::uint64_t* solid;  // solid cells, with margins
  const std::uint64_t* open;   // fluid cells whose links are listed
  bool reads_behind;           // list links whose cell behind is solid separately
};

/// The numbers of listed links: all but those of single-cell gaps (if told apart), and those.
struct LinkCounts {
  std::uint32_t clear, single_cell;
};

/// Rows [y0, y1) of the planes [z, z + planes) of a frame.
struct FrameRows {
  int z, planes, y0, y1;
};

/// The functions built for each instruction set.
struct BitKernels {
  /// Set the bits of cells inside a ball, or inside any part of a surface.
  void (*mark_sphere)(const BitFrame&, const PointInFrame&, double radius, std::uint64_t* words);
  void (*mark_parts)(const BitFrame&, const PointInFrame&, const rigid::SurfaceView<double>&,
                     std::uint64_t* words);
  /// Lists the links of rows. Both lists need room for link_lanes more than the links.
  LinkCounts (*list_links)(const BitFrame&, const FrameRows&, const LinkBits&, std::uint32_t* place,
                           std::uint32_t* single_cell);
  /// Lists those of n links (places from `corner`) whose cell behind is outside the block or whose second one
  /// is solid; returns their number. Reads whole vectors of places; the list needs room for n.
  std::uint32_t (*list_beyond)(const std::uint32_t* place, std::uint32_t n, lbm::Int3 corner,
                               const CellBits& solid, std::uint32_t* found);
  /// Sets in `to` all cells that have a neighbour along some c in a stream with margins.
  void (*widen)(const BitFrame&, const std::uint64_t* from, std::uint64_t* to);
  /// Lists cells x of rows and directions i of one half (c_i before its opposite) with x and x + c_i in
  /// `ends` and one of them in `own` (streams with margins). Returns their number n; needs room for n +
  /// link_lanes.
  std::uint32_t (*list_crossings)(const BitFrame&, const FrameRows&, const std::uint64_t* ends,
                                  const std::uint64_t* own, std::uint32_t* place);
};
SILT_BUILDS(BitKernels bit_kernels();)
/// Returns the kernels for this CPU.
inline const BitKernels& bit_kernels() {
  static const BitKernels kernels = SILT_CHOSEN(bit_kernels)();
  return kernels;
}

}  // namespace silt::coupler
