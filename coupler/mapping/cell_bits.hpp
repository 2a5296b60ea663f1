#pragma once
// The cells of a block as bits, with ghost cells: one word holds 64 cells of a row.
#include <cstdint>
#include <vector>

#include "lbm/blocks/block.hpp"

namespace silt::coupler {

/// Returns the first n cells of a word (n may exceed 64).
inline std::uint64_t first_cells(std::uint64_t cells, int n) {
  return n >= 64 ? cells : cells & ((std::uint64_t{1} << n) - 1);
}

/// Rows of bits over a block and `ghosts` layers around it: bit x + ghosts of row (y, z). One word before and
/// three after the rows may be read.
class CellBits {
 public:
  static constexpr int ghosts = 2;  // links read the second cell behind theirs
  CellBits() = default;
  explicit CellBits(lbm::Int3 size)
      : size_(size),
        words_((size.x + 2 * ghosts + 63) / 64),
        bits_(std::size_t(words_) * (size.y + 2 * ghosts) * (size.z + 2 * ghosts) + 4) {}
  int words() const { return words_; }
  std::size_t row(int y, int z) const { return row(size_, y, z, words_); }
  /// Returns the word at which a row begins, in a block of `size` cells with `words` words per row.
  SILT_DEVICE static std::size_t row(lbm::Int3 size, int y, int z, int words) {
    return 1 + std::size_t(words) * ((z + ghosts) * (size.y + 2 * ghosts) + (y + ghosts));
  }
  std::uint64_t* at(int y, int z) { return bits_.data() + row(y, z); }
  const std::uint64_t* at(int y, int z) const { return bits_.data() + row(y, z); }
  /// Returns 64 cells of a row from cell x on; bits beyond the row are undefined.
  std::uint64_t from(int x, int y, int z) const { return from(at(y, z), x); }
  SILT_DEVICE static std::uint64_t from(const std::uint64_t* row, int x) {
    const int bit = x + ghosts;
    const std::uint64_t* const w = row + (bit >> 6);
    return w[0] >> (bit & 63) | w[1] << 1 << (63 - (bit & 63));
  }
  /// Flips the cells of a word whose bit 0 is cell x.
  void flip(int x, int y, int z, std::uint64_t cells) {
    const int bit = x + ghosts;
    std::uint64_t* const w = at(y, z) + (bit >> 6);
    w[0] ^= cells << (bit & 63);
    if (const std::uint64_t beyond = cells >> 1 >> (63 - (bit & 63))) w[1] ^= beyond;
  }
  /// Returns the index of the bit of a cell, in a block of `size` cells with `words` words per row.
  SILT_DEVICE static std::size_t index(lbm::Int3 size, lbm::Int3 c, int words) {
    return 64 * row(size, c.y, c.z, words) + std::size_t(c.x + ghosts);
  }
  bool test(lbm::Int3 c) const {
    const int bit = c.x + ghosts;
    return at(c.y, c.z)[bit >> 6] >> (bit & 63) & 1;
  }
  void set(lbm::Int3 c) {
    const int bit = c.x + ghosts;
    at(c.y, c.z)[bit >> 6] |= std::uint64_t{1} << (bit & 63);
  }
  std::vector<std::uint64_t>& all() { return bits_; }
  const std::vector<std::uint64_t>& all() const { return bits_; }
  lbm::Int3 size() const { return size_; }

 private:
  lbm::Int3 size_;
  int words_ = 0;
  std::vector<std::uint64_t> bits_;
};

/// Calls f(x) for every set bit of word k, with x in block coordinates.
template <class F>
void for_bits(std::uint64_t word, int k, F&& f) {
  for (; word; word &= word - 1) f(k * 64 + __builtin_ctzll(word) - CellBits::ghosts);
}

/// The solid cells near a block's two faces across x, within CellBits::ghosts of a face on either side, as
/// columns of bits along y: rows along x have few of them per word.
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
