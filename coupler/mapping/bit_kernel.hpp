#pragma once
// The kernels of object mapping, built once an instruction set: bits of bodies, bits of cut links and their
// lists.
#include <cstdint>

#include "coupler/mapping/bit_window.hpp"
#include "coupler/mapping/cell_bits.hpp"
#include "cpu/isa.hpp"
#include "rigid/shapes/surface_kinds.hpp"

namespace silt::coupler {

/// The reference point of a body seen from a frame.
struct PointInFrame {
  double x, y, z;  // bitwise the same for every frame, but for whole cells
  lbm::Int3 low;   // cell of the frame's bit 0, in the coordinates of the point
};

/// The bits from which the links of one surface are listed: streams of one frame.
struct LinkBits {
  const std::uint64_t* body;   // with margins
  const std::uint64_t* solid;  // with margins
  const std::uint64_t* open;   // fluid cells whose links are wanted
  bool reads_behind;           // links whose cell behind is solid are listed apart
};

/// How many links were listed: those whose cell behind does not matter, and those of single-cell gaps.
struct LinkCounts {
  std::uint32_t clear, single_cell;
};

/// Rows [y0, y1) of the planes [z, z + planes) of a frame.
struct FrameRows {
  int z, planes, y0, y1;
};

/// The functions that each build for an instruction set has.
struct BitKernels {
  /// Sets the bits of the cells inside a ball, or inside any part of a surface.
  void (*mark_sphere)(const BitFrame&, const PointInFrame&, double radius, std::uint64_t* words);
  void (*mark_parts)(const BitFrame&, const PointInFrame&, const rigid::SurfaceView<double>&,
                     std::uint64_t* words);
  /// Lists the links of some rows. Both lists need link_lanes of room more than they get.
  LinkCounts (*list_links)(const BitFrame&, const FrameRows&, const LinkBits&, std::uint32_t* place,
                           std::uint32_t* single_cell);
  /// Lists which of n links, at places that count from a cell of the block, have the cell behind outside of
  /// the block, or behind that one a solid cell. Whole vectors of places are read; the list needs room for n.
  std::uint32_t (*list_beyond)(const std::uint32_t* place, std::uint32_t n, lbm::Int3 corner,
                               const CellBits& solid, std::uint32_t* found);
  /// Sets in `to` the cells next to one of a stream (with margins), along any c.
  void (*widen)(const BitFrame&, const std::uint64_t* from, std::uint64_t* to);
  /// Lists the cells x of some rows and the directions i of one half (c_i before its opposite) such that x
  /// and x + c_i are of `ends` and at least one of them of `own` (streams with margins). Returns how many;
  /// the list needs link_lanes of room more.
  std::uint32_t (*list_crossings)(const BitFrame&, const FrameRows&, const std::uint64_t* ends,
                                  const std::uint64_t* own, std::uint32_t* place);
};
SILT_BUILDS(BitKernels bit_kernels();)
/// Returns the functions of the build that runs here.
inline const BitKernels& bit_kernels() {
  static const BitKernels kernels = SILT_CHOSEN(bit_kernels)();
  return kernels;
}

}  // namespace silt::coupler
