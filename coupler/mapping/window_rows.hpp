#pragma once
// A window of bits filled row by row from cells of a block.
#include <algorithm>
#include <cstdint>

#include "coupler/mapping/bit_window.hpp"

namespace silt::coupler {

/// Sets what row(x, y, z), 64 bits of cells from x on, has in a window; in rows of the block and of so many
/// ghost layers, as far as the window has them.
template <class Row>
void fill_rows(BitWindow& window, lbm::Int3 block, int layers, Row&& row) {
  const BitFrame& f = window.frame();
  const std::uint64_t width = f.pitch >= 64 ? ~std::uint64_t{0} : (std::uint64_t{1} << f.pitch) - 1;
  for (int z = std::max(f.low.z, -layers); z < std::min(f.low.z + f.size.z, block.z + layers); ++z)
    for (int y = std::max(f.low.y, -layers); y < std::min(f.low.y + f.size.y, block.y + layers); ++y) {
      const std::size_t bit = f.row(y, z);
      for (int x = 0; x < f.pitch; x += 64)
        window.words()[(bit + x) >> 6] |= (row(f.low.x + x, y, z) & width) << (bit & 63);
    }
}

/// Bits [from, to) of 64 that stand for cells from x on.
inline std::uint64_t cells_between(int x, int from, int to) {
  const int a = std::clamp(from - x, 0, 64), b = std::clamp(to - x, 0, 64);
  if (a >= b) return 0;
  return (~std::uint64_t{0} >> (64 - (b - a))) << a;
}

}  // namespace silt::coupler
