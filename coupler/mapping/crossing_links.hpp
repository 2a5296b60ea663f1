#pragma once
// Crossing links: between two fluid cells x and x + c_i on the two sides of an edge, whose straight line
// passes through the body. They are cut at both ends (method-walls.md, "Edges").
//
// An end overwrites one slot that its other end reads, and no slot that any other crossing link reads, if
// - only one side of a line through a cell is cut, and
// - neither x nor x + c_i is next to a solid cell that is not of the body.
// Both ends are tested alike, so that two blocks agree on a link between them.
#include <cstdint>
#include <vector>

#include "coupler/mapping/solid_map.hpp"
#include "lbm/walls/cut_links.hpp"
#include "rigid/shapes/surface_kinds.hpp"

namespace silt::coupler {

template <class T>
class CrossingLinks {
 public:
  static constexpr int planes = (1 << lbm::place_z_bits) - 2;  // listed at a time: a link ends one plane off

  /// Finds the cells of the block, and of its first ghost layer, where crossing links of a body may be.
  void find_cells(const BlockMap&, const BodyMask&);
  /// Lists the links that begin in planes [z, z + planes) of the mask's frame and end inside the block.
  /// Places count from the frame's cell (0, 0, z - 1). First those both ends of which are inside, an end
  /// beside the other.
  void list(int z, const lbm::SurfaceFrame&, const rigid::SurfaceView<T>&);

  const std::vector<std::uint32_t>& place() const { return place_; }
  const std::vector<T>& q() const { return q_; }

 private:
  struct Ends {
    std::vector<std::uint32_t> place;
    std::vector<T> q;
  };
  void list_candidates(int z);
  void measure(Ends&, lbm::Int3 corner, const lbm::SurfaceFrame&, const rigid::SurfaceView<T>&) const;

  BitFrame frame_;
  lbm::CellBox block_;                 // in its own coordinates
  BitWindow fluid_, own_;              // cells, ghosts too; cells of the block
  BitWindow others_, beside_others_;   // solid and not of the body; cells next to these
  BitWindow near_;                     // where links may begin and end
  Ends begin_, end_, before_, after_;  // of the line of a candidate: towards each other, away from each other
  std::vector<std::uint32_t> place_;
  std::vector<T> q_;
};

}  // namespace silt::coupler
