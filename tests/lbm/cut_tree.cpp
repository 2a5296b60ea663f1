// Trees of cuts and domains, and the order in which a pass goes over a block.
#include <gtest/gtest.h>

#include <algorithm>
#include <random>
#include <set>
#include <vector>

#include "lbm/blocks/block.hpp"
#include "lbm/blocks/cut_tree.hpp"
#include "lbm/blocks/domain.hpp"
#include "lbm/blocks/equal_cut.hpp"
#include "lbm/blocks/pass_order.hpp"
#include "lbm/walls/pairs_across.hpp"
#include "tests/odd_cut.hpp"

namespace silt::lbm {
namespace {

using tests::odd_cut;

template <class F>
void for_cells(const CellBox& box, F&& f) {
  for_cells(box.lower, box.lower + box.size, f);
}

bool same(const CellBox& a, const CellBox& b) {
  return a.lower == b.lower && a.size == b.size;
}

/// The box of every leaf is the one its cells say, and the leaves cover the whole.
void expect_partition(const CutTree& tree) {
  const Int3 n = tree.cells();
  std::vector<char> covered(std::size_t(n.x) * n.y * n.z, 0);
  for (int k = 0; k < tree.leaves(); ++k) {
    const CutTree::Leaf leaf = tree.leaf(k);
    ASSERT_EQ(leaf.index, k);
    for_cells(leaf.box, [&](Int3 x) {
      ASSERT_TRUE((CellBox{{}, n}.contains(x)));
      ++covered[(std::size_t(x.z) * n.y + x.y) * n.x + x.x];
      const CutTree::Leaf found = tree.leaf_at(x);
      ASSERT_TRUE(found.index == k && same(found.box, leaf.box));
    });
  }
  EXPECT_TRUE(std::all_of(covered.begin(), covered.end(), [](char times) { return times == 1; }));
}

constexpr Int3 boxes[] = {{32, 32, 32}, {40, 9, 17}, {3, 128, 16}, {130, 1, 16}, {16, 33, 24}};

TEST(CutTree, EveryCellIsInOneLeaf) {
  for (const Int3 cells : boxes)
    for (int leaves = 1; leaves <= 64; ++leaves) {
      SCOPED_TRACE(::testing::Message()
                   << leaves << " of " << cells.x << " x " << cells.y << " x " << cells.z);
      const CutTree equal = equal_cut(cells, leaves), odd = odd_cut(cells, leaves, 2, leaves);
      EXPECT_EQ(equal.leaves(), leaves);
      EXPECT_EQ(odd.leaves(), leaves);
      expect_partition(equal);
      expect_partition(odd);
    }
  expect_partition(grid_cut({24, 25, 7}, {6, 9, 2}));
}

TEST(CutTree, LeavesThatMeetABoxAreThoseOfItsCells) {
  std::mt19937 random(1);
  for (const Int3 cells : boxes)
    for (const int leaves : {1, 2, 7, 29, 64}) {
      const CutTree tree = odd_cut(cells, leaves, 1, leaves);
      for (int trial = 0; trial < 100; ++trial) {
        CellBox box;
        for (int d = 0; d < 3; ++d) {
          box.lower[d] = std::uniform_int_distribution<>(0, cells[d] - 1)(random);
          box.size[d] = std::uniform_int_distribution<>(1, cells[d] - box.lower[d])(random);
        }
        std::vector<int> found, expected;
        tree.for_leaves_meeting(box, [&](const CutTree::Leaf& leaf) {
          found.push_back(leaf.index);
          EXPECT_TRUE(same(leaf.box, tree.leaf(leaf.index).box));
        });
        for (int k = 0; k < leaves; ++k)
          if (overlap(tree.leaf(k).box, box).cells() > 0) expected.push_back(k);
        ASSERT_EQ(found, expected);
      }
    }
}

TEST(CutTree, PlanesOutsideTheirPartAreRefused) {
  const Int3 n{8, 8, 8};
  EXPECT_NO_THROW(CutTree(n, {{0, 4, 2}, {1, 1, 1}}));
  EXPECT_THROW(CutTree(n, {{0, 0, 1}}), std::invalid_argument);
  EXPECT_THROW(CutTree(n, {{2, 8, 1}}), std::invalid_argument);
  EXPECT_THROW(CutTree(n, {{3, 4, 1}}), std::invalid_argument);
  EXPECT_THROW(CutTree(n, {{0, 4, 2}}), std::invalid_argument);
  EXPECT_THROW(CutTree(n, {{0, 4, 2}, {0, 6, 1}}), std::invalid_argument);  // of the upper part
}

// A box of 8 cells an edge for each leaf: that many an edge they have, too; else as many as there are.
TEST(EqualCut, LeavesHaveTheEdgesThereIsRoomFor) {
  const auto least = [](const CutTree& tree) {
    int edge = 1000;
    for (int k = 0; k < tree.leaves(); ++k)
      for (int d = 0; d < 3; ++d) edge = std::min(edge, tree.leaf(k).box.size[d]);
    return edge;
  };
  for (int leaves = 1; leaves <= 64; ++leaves) EXPECT_GE(least(equal_cut({32, 32, 32}, leaves)), 8);
  for (int leaves = 1; leaves <= 12; ++leaves) EXPECT_GE(least(equal_cut({16, 24, 16}, leaves)), 8);
  EXPECT_GE(least(equal_cut({16, 16, 16}, 64)), 4);
  EXPECT_EQ(least(equal_cut({16, 16, 16}, 512)), 2);
  EXPECT_THROW(equal_cut({16, 16, 16}, 513), std::invalid_argument);
  EXPECT_EQ(least(equal_cut({1, 16, 16}, 4)), 1);  // it has no more along x
  EXPECT_EQ(equal_cut({1, 16, 16}, 64).leaves(), 64);
}

// If planes may lie anywhere, leaves differ by what rounding to whole cells leaves; rows are cut last.
TEST(EqualCut, LeavesAreOfOneSizeAndRowsStayLong) {
  for (int leaves = 1; leaves <= 64; ++leaves) {
    const CutTree tree = equal_cut({240, 240, 240}, leaves);
    std::int64_t most = 0;
    for (int k = 0; k < leaves; ++k) most = std::max(most, tree.leaf(k).box.cells());
    EXPECT_LT(double(most) * leaves / (240. * 240 * 240), 1.04) << leaves << " leaves";
    if (leaves <= 4) {
      EXPECT_EQ(tree.leaf(0).box.size.x, 240);
    }
  }
}

TEST(GridCut, IsAGrid) {
  const CutTree tree = grid_cut({24, 25, 7}, {6, 9, 2});
  EXPECT_EQ(tree.leaves(), 4 * 3 * 4);
  std::set<int> sides[3];
  for (int k = 0; k < tree.leaves(); ++k)
    for (int d = 0; d < 3; ++d) sides[d].insert(tree.leaf(k).box.lower[d]);
  EXPECT_EQ(sides[0], (std::set{0, 6, 12, 18}));
  EXPECT_EQ(sides[1], (std::set{0, 8, 16}));
  EXPECT_EQ(sides[2], (std::set{0, 1, 3, 5}));
}

TEST(Domain, RanksHaveContiguousRunsOfBlocks) {
  for (const int blocks : {1, 2, 7, 12, 64})
    for (int ranks = 1; ranks <= blocks; ++ranks) {
      const Domain domain(odd_cut({32, 32, 32}, blocks), {}, ranks);
      int next = 0;
      for (int rank = 0; rank < ranks; ++rank) {
        const auto mine = domain.blocks_of(rank);
        EXPECT_GE(int(mine.size()), blocks / ranks);
        EXPECT_LE(int(mine.size()), (blocks + ranks - 1) / ranks);
        for (const BlockPlace& place : mine) {
          EXPECT_EQ(place.index, next++);
          EXPECT_EQ(domain.rank_of(place.index), rank);
          EXPECT_EQ(domain.local_index(place, rank), int(&place - mine.data()));
        }
      }
      EXPECT_EQ(next, blocks);
    }
  EXPECT_THROW(Domain(odd_cut({32, 32, 32}, 3), {}, 4), std::invalid_argument);
}

// The blocks of the 26 cells around each cell of a block, whatever part of a face they share.
TEST(Domain, NeighboursAreTheBlocksOfNeighbouringCells) {
  std::array<SideCondition, 6> walls;
  walls.fill({SideKind::bounce, {}, 0});
  std::array<SideCondition, 6> mixed = walls;
  mixed[2] = mixed[3] = {};
  for (const auto& sides : {std::array<SideCondition, 6>{}, walls, mixed})
    for (const Int3 cells : {Int3{12, 13, 11}, Int3{3, 24, 8}})
      for (const int blocks : {1, 2, 3, 11}) {
        const Domain domain(odd_cut(cells, blocks, 1, blocks), sides, blocks);
        for (int b = 0; b < blocks; ++b) {
          std::set<int> expected;
          for_cells(domain.block(b).box, [&](Int3 x) {
            for_cells({x - Int3{1, 1, 1}, {3, 3, 3}}, [&](Int3 y) {
              if (domain.inside(domain.wrapped(y))) expected.insert(domain.block_at(domain.wrapped(y)).index);
            });
          });
          EXPECT_EQ(domain.neighbourhood(b), std::vector(expected.begin(), expected.end()));
        }
      }
}

/// A box of 24^3 finest cells: its middle is of level 0, the rest of level 1, but for a part that is not
/// known.
CutTree levelled() {
  return CutTree({24, 24, 24}, {{0, 8, 1}, {0, 16, 5}, {1, 8, 1}, {1, 16, 3}, {2, 8, 1}, {2, 16, 1}},
                 {{0, 1}, {0, 1}, {0, 1}, {1, 0}, {0, 1}, {1, 1}, {1, LeafKind::far}});
}

TEST(Domain, OfALevelHasTheBlocksOfItsLevel) {
  const Domain coarse(levelled(), {}, 2, 1), fine(levelled(), {}, 2);
  EXPECT_EQ(coarse.cells(), (Int3{12, 12, 12}));
  EXPECT_EQ(coarse.blocks_of(0).size(), 4u);
  EXPECT_EQ(coarse.blocks_of(1).size(), 1u);
  ASSERT_EQ(fine.blocks_of(1).size(), 1u);
  EXPECT_EQ(fine.blocks_of(0).size(), 0u);
  const BlockPlace middle = fine.blocks_of(1)[0];
  EXPECT_EQ(middle.box.lower, (Int3{8, 8, 8}));
  EXPECT_EQ(fine.local_index(middle, 1), 0);
  EXPECT_TRUE(fine.has({15, 8, 15}));
  EXPECT_FALSE(fine.has({7, 8, 8}));
  EXPECT_FALSE(coarse.has({4, 4, 4}));
  EXPECT_EQ(fine.neighbourhood(middle.index), std::vector{middle.index});
  int met = 0;
  coarse.for_blocks_meeting(CellBox{{3, 3, 3}, {6, 6, 6}}, [&](const BlockPlace&) { ++met; });
  EXPECT_EQ(met, 5);
  EXPECT_THROW(CutTree({24, 24, 24}, {{0, 7, 1}}, {{0, 1}, {0, 0}}), std::invalid_argument);
  EXPECT_THROW(CutTree({24, 24, 24}, {{0, 8, 1}}, {{0, 1}}), std::invalid_argument);
}

/// Counts, for every row, the calls that collide it; -2: not yet.
struct Rows {
  Int3 size;
  std::vector<int> part;  // that did it; -1: the shell
  explicit Rows(Int3 n) : size(n), part(std::size_t(n.y) * n.z, -2) {}
  int& at(int y, int z) { return part[std::size_t(z) * size.y + y]; }
  void collide(const RowRange& rows, int by) {
    for (int z = rows.z0; z < rows.z1; ++z)
      for (int y = rows.y0; y < rows.y1; ++y) {
        EXPECT_EQ(at(y, z), -2) << "row " << y << ", " << z << " collides twice";
        at(y, z) = by;
      }
  }
};

/// Cells are ready when all up to `reach` away have collided.
void expect_ready(const PassOrder& order, Rows& rows, int reach) {
  const Int3 n = rows.size;
  for (int z = reach; z < n.z - reach; ++z)
    for (int y = reach; y < n.y - reach; ++y) {
      int last = -2;
      for (int k = -reach; k <= reach; ++k)
        for (int j = -reach; j <= reach; ++j) last = std::max(last, rows.at(y + j, z + k));
      EXPECT_EQ(order.ready(y, z, reach), last) << y << ", " << z;
      EXPECT_GT(order.next_row(y, reach), y);
      if (y + 1 < order.next_row(y, reach) && y + 1 < n.y - reach) {
        EXPECT_EQ(order.ready(y, z, reach), order.ready(y + 1, z, reach));
      }
    }
}

void expect_order(const PassOrder& order, Int3 n) {
  Rows rows(n);
  for (const RowRange& range : order.shell()) rows.collide(range, -1);
  for (int part = 0; part < order.parts(); ++part) rows.collide(order.rows_of(part), part);
  for (int z = 0; z < n.z; ++z)
    for (int y = 0; y < n.y; ++y) {
      EXPECT_EQ(rows.at(y, z), order.part_of(y, z)) << y << ", " << z;
      EXPECT_EQ(rows.at(y, z) == -1, order.in_shell(y, z));
    }
  for (int reach = 1; reach <= 2; ++reach) expect_ready(order, rows, reach);
}

TEST(PassOrder, CollidesEveryRowOnceAndKnowsWhatIsReady) {
  for (const Int3 n :
       {Int3{64, 7, 5}, Int3{700, 30, 6}, Int3{2000, 26, 4}, Int3{16, 2, 2}, Int3{16, 1, 1}, Int3{16, 5, 1}})
    for (int faces = 0; faces < 16; ++faces) {
      SCOPED_TRACE(::testing::Message() << n.y << " x " << n.z << " rows, faces " << faces);
      const ShellFaces shell{{bool(faces & 1), bool(faces & 2)}, {bool(faces & 4), bool(faces & 8)}};
      expect_order(PassOrder(n, 8, shell), n);
    }
}

TEST(PlacesAcross, AreOfOneCellAndDirection) {
  for (const Int3 n : {Int3{7, 5, 6}, Int3{1, 4, 3}, Int3{2, 2, 2}, Int3{1, 1, 1}, Int3{9, 1, 2}}) {
    SCOPED_TRACE(::testing::Message() << n.x << " x " << n.y << " x " << n.z << " cells");
    const PlacesAcross<D3Q19> place(n);
    const CellBox block{{}, n};
    std::vector<int> taken(place.count(), 0);
    std::size_t links = 0;
    for (int i = 1; i < D3Q19::directions; ++i)
      for_cells(block, [&](Int3 x) {
        if (block.contains(x - D3Q19::c[i])) return;
        const std::uint32_t at = place(x, i);
        ASSERT_LT(at, place.count());
        EXPECT_EQ(taken[at]++, 0) << x.x << ", " << x.y << ", " << x.z << " along " << i;
        ++links;
      });
    EXPECT_EQ(place.count() - links, std::size_t(4 * (n.x + n.y + n.z)));  // edges, counted twice
  }
}

}  // namespace
}  // namespace silt::lbm
