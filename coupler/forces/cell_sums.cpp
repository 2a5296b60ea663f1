#include "coupler/forces/cell_sums.hpp"

#include <algorithm>
#include <bit>

namespace silt::coupler {

using lbm::Int3;

namespace {

/// Sum of the positions of the bits that are set.
int sum_of_positions(std::uint64_t word) {
  constexpr std::uint64_t with_bit[] = {0xAAAAAAAAAAAAAAAA, 0xCCCCCCCCCCCCCCCC, 0xF0F0F0F0F0F0F0F0,
                                        0xFF00FF00FF00FF00, 0xFFFF0000FFFF0000, 0xFFFFFFFF00000000};
  int sum = 0;
  for (int b = 0; b < 6; ++b) sum += std::popcount(word & with_bit[b]) << b;
  return sum;
}

/// Of a word whose bit 0 is cell x of a row: those that are inside the block.
std::uint64_t inside(std::uint64_t word, int x, int size) {
  if (x <= -64 || x >= size) return 0;
  if (x < 0) word &= ~std::uint64_t{0} << -x;
  if (size - x < 64) word &= (std::uint64_t{1} << (size - x)) - 1;
  return word;
}

}  // namespace

CellSums cells_of(const lbm::CellBox& box, const BodyMask& mask) {
  CellSums sums;
  const BitFrame& f = mask.frame();
  const Int3 corner = box.lower + Int3{-mask.shift.x, -mask.shift.y, -mask.shift.z};
  for (int z = std::max(f.low.z, 0); z < std::min(f.low.z + f.size.z, box.size.z); ++z)
    for (int y = std::max(f.low.y, 0); y < std::min(f.low.y + f.size.y, box.size.y); ++y)
      for (int x = 0; x < f.size.x; x += 64) {
        const std::uint64_t word = inside(mask.bits.row(x, y, z), f.low.x + x, box.size.x);
        const std::int64_t n = std::popcount(word);
        sums.count += n;
        sums.coordinates[0] += sum_of_positions(word) + n * (corner.x + f.low.x + x);
        sums.coordinates[1] += n * (corner.y + y);
        sums.coordinates[2] += n * (corner.z + z);
      }
  return sums;
}

}  // namespace silt::coupler
