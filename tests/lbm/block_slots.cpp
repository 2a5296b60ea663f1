// A population has one slot, whatever the lattice: what leaves a cell along c_i arrives in the cell at c_i.
#include <gtest/gtest.h>

#include <set>

#include "lbm/blocks/block.hpp"

namespace silt::lbm::testing {

template <class Lattice>
struct BlockSlots : ::testing::Test {};
using Lattices = ::testing::Types<D3Q19, D3Q7>;
TYPED_TEST_SUITE(BlockSlots, Lattices);

TYPED_TEST(BlockSlots, OneForEachPopulation) {
  const Block<double, TypeParam> block({{}, {6, 5, 4}});
  for (const Parity parity : {Parity::settled, Parity::crossed}) {
    std::set<std::ptrdiff_t> slots;
    for (int i = 0; i < TypeParam::directions; ++i)
      for_cells({}, block.size(), [&](Int3 x) {
        const std::ptrdiff_t slot = block.arriving(i, parity) + block.cell(x);
        EXPECT_TRUE(slots.insert(slot).second) << i << " at " << x.x << " " << x.y << " " << x.z;
        EXPECT_EQ(slot, block.leaving(i, parity) + block.cell(x - TypeParam::c[i]));
      });
    EXPECT_EQ(slots.size(), std::size_t(TypeParam::directions) * 6 * 5 * 4);
  }
}

/// The ghost slots are those of populations that cross out of the block, one each.
TYPED_TEST(BlockSlots, GhostsAreWhatCrossesOut) {
  const Int3 size{6, 5, 4};
  std::set<std::array<int, 4>> ghosts;
  for_ghost_slots<TypeParam>(size, [&](Int3 g, int j) {
    EXPECT_TRUE(ghosts.insert({g.x, g.y, g.z, j}).second);
  });
  const CellBox inside{{}, size};
  std::size_t crossing = 0;
  for (int j = 1; j < TypeParam::directions; ++j)
    for_cells({}, size, [&](Int3 x) {
      const Int3 g = x + TypeParam::c[j];
      if (inside.contains(g)) return;
      ++crossing;
      EXPECT_TRUE(ghosts.contains({g.x, g.y, g.z, j}));
    });
  EXPECT_EQ(ghosts.size(), crossing);
}

}  // namespace silt::lbm::testing
