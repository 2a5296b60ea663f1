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
  /// Sets the cells of a word whose bit 0 is cell x.
  void add(int x, int y, int z, std::uint64_t cells) {
    const int bit = x + ghosts;
    std::uint64_t* const w = at(y, z) + (bit >> 6);
    w[0] |= cells << (bit & 63);
    if (const std::uint64_t beyond = cells >> 1 >> (63 - (bit & 63))) w[1] |= beyond;
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

}  // namespace silt::coupler
