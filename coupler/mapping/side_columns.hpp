#pragma once
// The solid cells near a block's two faces across x as bits along y: rows along x have few per word.
#include <cstdint>
#include <vector>

#include "coupler/mapping/cell_bits.hpp"

namespace silt::coupler {

/// Columns of bits of the cells within CellBits::ghosts of a face, on either side.
class SideColumns {
 public:
  explicit SideColumns(const CellBits& solid) { reset(solid); }
  void reset(const CellBits& solid) {
    size_ = solid.size();
    words_ = (size_.y + 2 * ghosts + 63) / 64 + 1;
    bits_.assign(std::size_t(words_) * depth * sides * (size_.z + 2 * ghosts), 0);
    for (int z = -ghosts; z < size_.z + ghosts; ++z)
      for (int y = -ghosts; y < size_.y + ghosts; ++y)
        for (int side = 0; side < sides; ++side) {
          std::uint64_t row = solid.from(side * size_.x - ghosts, y, z) & ((1u << depth) - 1);
          for (; row; row &= row - 1) {
            std::uint64_t* const column = bits_.data() + start(side, __builtin_ctzll(row), z);
            column[(y + ghosts) >> 6] |= std::uint64_t{1} << ((y + ghosts) & 63);
          }
        }
  }
  /// Returns 64 cells of a column of `solid` from y on, as of the last reset; bits beyond the column are
  /// undefined. Collects columns far from the faces, at corners of blocks that are not aligned, from `solid`.
  std::uint64_t from(const CellBits& solid, int x, int y, int z) const {
    const int side = x >= ghosts ? 1 : 0, column = x - side * size_.x + ghosts, bit = y + ghosts;
    if (column < 0) return put_together(solid, x, y, z);
    const std::uint64_t* const w = bits_.data() + start(side, column, z) + (bit >> 6);
    return w[0] >> (bit & 63) | w[1] << 1 << (63 - (bit & 63));
  }

 private:
  static constexpr int ghosts = CellBits::ghosts, depth = 2 * ghosts, sides = 2;

  std::size_t start(int side, int column, int z) const {
    return std::size_t(words_) * ((z + ghosts) * sides * depth + side * depth + column);
  }

  std::uint64_t put_together(const CellBits& solid, int x, int y, int z) const {
    std::uint64_t column = 0;
    for (int n = 0; n < 64 && y + n < size_.y + ghosts; ++n)
      column |= std::uint64_t(solid.test({x, y + n, z})) << n;
    return column;
  }

  lbm::Int3 size_;
  int words_ = 0;  // per column, with one more to read
  std::vector<std::uint64_t> bits_;
};

}  // namespace silt::coupler
