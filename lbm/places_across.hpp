#pragma once
// Where the pair of a link lies (BeyondPair) whose cell behind is not of the link's block.
#include <array>
#include <cstdint>

#include "lbm/lattice.hpp"

namespace silt::lbm {

/// The places of a block's pairs across (PairsAcross): one for each cell x and direction i with x - c_i
/// outside the block. Faces of the block are counted whole, so some places are of no cell.
class PlacesAcross {
 public:
  explicit PlacesAcross(Int3 block_size) : size_(block_size) {
    for (int i = 1; i < directions; ++i)
      for (int d = 0; d < 3; ++d) {
        first_[i][d] = count_;
        if (c[i][d] != 0) count_ += std::uint32_t(size_[(d + 1) % 3]) * std::uint32_t(size_[(d + 2) % 3]);
      }
  }
  /// The last axis along which a link of a cell enters a block.
  static int axis_of(Int3 cell, int direction, Int3 block_size) {
    int d = 2;
    while (c[direction][d] == 0 || cell[d] != (c[direction][d] > 0 ? 0 : block_size[d] - 1)) --d;
    return d;
  }
  /// The cell lies in the block, the one behind it outside.
  std::uint32_t operator()(Int3 cell, int direction) const {
    const int d = axis_of(cell, direction, size_);
    const int e = d == 0 ? 1 : 0, f = d == 2 ? 1 : 2;  // along the face, in the order of cells in memory
    return first_[direction][d] + std::uint32_t(cell[f]) * std::uint32_t(size_[e]) + std::uint32_t(cell[e]);
  }
  /// All places are less than this.
  std::uint32_t count() const { return count_; }

 private:
  Int3 size_;
  std::array<std::array<std::uint32_t, 3>, directions> first_{};  // by direction and the axis of the face
  std::uint32_t count_ = 0;
};

}  // namespace silt::lbm
