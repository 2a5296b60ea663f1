// A population has one slot, whatever the lattice: what leaves a cell along c_i arrives in the cell at c_i.
#include <gtest/gtest.h>

#include <array>
#include <set>

#include "lbm/blocks/block.hpp"
#include "lbm/exchange/ghost_home.hpp"

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

/// What crosses out of a block of a domain, periodic along x and z alone, has one home, unless it meets a
/// side.
TYPED_TEST(BlockSlots, GhostsHaveOneHome) {
  using Lattice = TypeParam;
  std::array<SideCondition, 6> sides;
  sides[2].kind = sides[3].kind = SideKind::bounce;
  for (const Int3 block : {Int3{3, 2, 1}, Int3{6, 2, 2}, Int3{6, 4, 2}}) {
    const Domain domain({6, 4, 2}, sides, block, 1);
    for (int b = 0; b < domain.blocks(); ++b) {
      const CellBox box = domain.block(b).box;
      std::set<std::array<int, 4>> found;
      for_ghost_boxes<Lattice>(domain, box,
                               [&](const BlockPlace& home, Int3 way, const CellBox& ghosts, int j) {
                                 for_cells(ghosts.lower, ghosts.lower + ghosts.size, [&](Int3 g) {
                                   EXPECT_TRUE(found.insert({g.x, g.y, g.z, j}).second);
                                   EXPECT_EQ(g - way, domain.wrapped(g));
                                   EXPECT_EQ(home.index, domain.block_at(domain.wrapped(g)).index);
                                 });
                               });
      std::size_t crossing = 0;
      for (int j = 1; j < Lattice::directions; ++j)
        for_cells(box.lower, box.lower + box.size, [&](Int3 x) {
          const Int3 g = x + Lattice::c[j];
          if (box.contains(g) || !domain.inside(domain.wrapped(g))) return;
          ++crossing;
          EXPECT_TRUE(found.contains({g.x, g.y, g.z, j}));
        });
      EXPECT_EQ(found.size(), crossing);
    }
  }
}

}  // namespace silt::lbm::testing
