#pragma once
// The indices of the pairs of populations that links read across faces of a block (pairs_across.hpp).
#include <array>
#include <cstdint>

#include "cpu/device_code.hpp"
#include "lbm/blocks/block.hpp"

namespace silt::lbm {

/// The indices of a block's pairs across: one for each cell x and direction i with x - c_i outside the block.
/// Faces are counted whole, so some indices are unused.
template <class Lattice>
class PlacesAcross {
 public:
  explicit PlacesAcross(Int3 block_size) : size_(block_size) {
    for (int i = 1; i < Lattice::directions; ++i)
      for (int d = 0; d < 3; ++d) {
        first_[i][d] = count_;
        if (Lattice::c[i][d] != 0)
          count_ += std::uint32_t(size_[(d + 1) % 3]) * std::uint32_t(size_[(d + 2) % 3]);
      }
  }
  /// Returns the last axis along which a link along c enters the block at its cell.
  SILT_DEVICE static int axis_of(Int3 cell, Int3 c, Int3 block_size) {
    int d = 2;
    while (c[d] == 0 || cell[d] != (c[d] > 0 ? 0 : block_size[d] - 1)) --d;
    return d;
  }
  /// Returns the index of a pair; the cell must lie in the block, the cell behind it outside. `c` is that of
  /// the direction, since a device has no table of them.
  SILT_DEVICE std::uint32_t operator()(Int3 cell, int direction, Int3 c) const {
    const int d = axis_of(cell, c, size_);
    const int e = d == 0 ? 1 : 0, f = d == 2 ? 1 : 2;  // along the face, in the order of cells in memory
    return first_[direction][d] + std::uint32_t(cell[f]) * std::uint32_t(size_[e]) + std::uint32_t(cell[e]);
  }
  std::uint32_t operator()(Int3 cell, int direction) const {
    return (*this)(cell, direction, Lattice::c[direction]);
  }
  /// Returns the number of indices.
  std::uint32_t count() const { return count_; }

 private:
  Int3 size_;
  std::array<std::array<std::uint32_t, 3>, Lattice::directions>
      first_{};  // by direction and the axis of the face
  std::uint32_t count_ = 0;
};

}  // namespace silt::lbm
