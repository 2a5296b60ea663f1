#pragma once
// Crossing links connect two fluid cells x and x + c_i on the two sides of an edge through the body, and are
// cut at both ends (method-walls.md, "Edges").
//
// An end overwrites one slot that its other end reads, and no slot that other crossing links read, if
// - only one side of a line through a cell is cut, and
// - neither x nor x + c_i is next to a solid cell of another body or wall.
// Both ends are tested alike, so that two blocks agree on a link between them.
#include <cstdint>
#include <vector>

#include "coupler/mapping/device_mapping.hpp"
#include "coupler/mapping/solid_map.hpp"
#include "lbm/walls/cut_links.hpp"
#include "rigid/shapes/surface_kinds.hpp"

namespace silt::coupler {

template <class T>
class CrossingLinks {
 public:
  static constexpr int planes = EdgeSlab::most_planes;  // per list

  /// Finds the cells of the block and its first ghost layer where crossing links of a body may end.
  void find_cells(const BlockMap&, const BodyMask&);
  /// Lists the ends, inside the block, of links that begin in planes [z, z + planes) of the mask's frame.
  /// Places count from cell (0, 0, z - 1) of the frame. Links with both ends inside come first, as pairs.
  void list(int z, const lbm::SurfaceFrame&, const rigid::SurfaceView<T>&);

  const std::vector<std::uint32_t>& place() const { return place_; }
  const std::vector<T>& q() const { return q_; }

 private:
  std::uint32_t list_candidates(int z);

  BitFrame frame_;
  lbm::CellBox block_;                // in block coordinates
  BitWindow fluid_, own_;             // fluid cells, with ghosts; cells of the block
  BitWindow others_, beside_others_;  // solid cells of other surfaces; their neighbours
  BitWindow near_;                    // where links may begin or end
  std::vector<std::uint32_t> found_;  // from one end; distances from there and from the other end:
  std::vector<T> begin_, end_;
  std::vector<std::uint32_t> place_;
  std::vector<T> q_;
};

}  // namespace silt::coupler
