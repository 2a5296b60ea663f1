// Cuts of a domain by work.
#include <gtest/gtest.h>

#include <numeric>
#include <random>

#include "coupler/balance/weighted_cut.hpp"
#include "lbm/blocks/equal_cut.hpp"
#include "tests/world.hpp"

namespace silt::coupler {
namespace {

using lbm::CellBox;
using lbm::Int3;
using tests::rank;
using tests::ranks;

/// Tiles with work in a part of the domain, anywhere, the same on all ranks.
std::vector<WorkItem> scattered(Int3 cells, const CellBox& where, int count) {
  WorkMap map(lbm::Domain(lbm::equal_cut(cells, 1), {}, 1));
  std::mt19937 random(1);
  for (int n = 0; n < count; ++n) {
    Int3 cell;
    for (int d = 0; d < 3; ++d)
      cell[d] = std::uniform_int_distribution<>(where.lower[d], where.lower[d] + where.size[d] - 1)(random);
    map.add(cell, std::uniform_int_distribution<>(1, 50000)(random));
  }
  return map.items();
}

std::vector<WorkItem> dealt(const std::vector<WorkItem>& all, int shift) {
  std::vector<WorkItem> mine;
  for (std::size_t k = 0; k < all.size(); ++k)
    if (int((k + shift) % ranks()) == rank()) mine.push_back(all[k]);
  return mine;
}

/// Returns the work of each leaf, with items counted by the share of their cells.
std::vector<double> work_of_leaves(const lbm::CutTree& tree, std::int64_t work_of_a_cell,
                                   const std::vector<WorkItem>& items) {
  std::vector<double> work;
  for (int k = 0; k < tree.leaves(); ++k) {
    const CellBox box = tree.leaf(k).box;
    double& sum = work.emplace_back(double(work_of_a_cell) * double(box.cells()));
    for (const WorkItem& item : items) {
      double share = 1;
      for (int d = 0; d < 3; ++d) {
        const int low = std::max(box.lower[d], item.box.lower[d]);
        const int high = std::min(box.lower[d] + box.size[d], item.box.lower[d] + item.box.size[d]);
        share *= std::max(0, high - low) / double(item.box.size[d]);
      }
      sum += share * double(item.work);
    }
  }
  return work;
}

void expect_right(const WeightedCut& cut, std::int64_t work_of_a_cell, const std::vector<WorkItem>& items) {
  ASSERT_EQ(cut.tree.leaves(), ranks());
  const auto work = work_of_leaves(cut.tree, work_of_a_cell, items);
  const double all = std::accumulate(work.begin(), work.end(), 0.0);
  EXPECT_NEAR(cut.mean * ranks(), all, 1e-9 * all + 1);
  EXPECT_NEAR(cut.largest, *std::max_element(work.begin(), work.end()), 1e-3 * cut.mean + 1);
}

TEST(WeightedCut, SharesOutAllOfTheWork) {
  const Int3 cells{96, 100, 90};
  const auto items = scattered(cells, {{}, cells}, 2000);
  for (const std::int64_t cell : {0, 10}) {
    const WeightedCut cut = weighted_cut(MPI_COMM_WORLD, cells, cell, dealt(items, 0));
    expect_right(cut, cell, items);
    EXPECT_LT(cut.largest_over_mean(), 1.05);
  }
}

// All of them in the lowest quarter, where tiles cost four times the fluid in them.
TEST(WeightedCut, EvensOutWorkAtTheBottom) {
  const Int3 cells{96, 96, 96};
  const auto items = scattered(cells, {{}, {96, 96, 24}}, 400);
  const WeightedCut cut = weighted_cut(MPI_COMM_WORLD, cells, 10, dealt(items, 1));
  expect_right(cut, 10, items);
  EXPECT_LE(cut.largest_over_mean(), 1.05);
  const lbm::Domain equal(lbm::equal_cut(cells, ranks()), {}, ranks());
  const auto before = work_of_leaves(equal.tree(), 10, items);
  if (ranks() > 1) {
    EXPECT_GT(*std::max_element(before.begin(), before.end()) / cut.mean, 1.5);
  }
}

TEST(WeightedCut, WithoutItemsIsByCells) {
  const Int3 cells{64, 64, 64};
  for (const std::int64_t cell : {0, 10}) {
    const WeightedCut cut = weighted_cut(MPI_COMM_WORLD, cells, cell, {});
    const auto volumes = work_of_leaves(cut.tree, 1, {});
    EXPECT_LT(*std::max_element(volumes.begin(), volumes.end()) * ranks(), 1.1 * 64 * 64 * 64);
  }
}

TEST(WeightedCut, LeavesRoomWhereAllWorkIsInOnePlace) {
  const Int3 cells{32, 16, 16};
  const std::vector<WorkItem> items{{{{24, 8, 0}, {8, 8, 8}}, 1000000}};
  const WeightedCut cut = weighted_cut(MPI_COMM_WORLD, cells, 1, dealt(items, 0));
  expect_right(cut, 1, items);
  for (int k = 0; k < ranks(); ++k)
    for (int d = 0; d < 3; ++d) EXPECT_GE(cut.tree.leaf(k).box.size[d], 8);
}

TEST(WeightedCut, PresentWorkIsThatOfTheBlocks) {
  const Int3 cells{32, 32, 32};
  const lbm::Domain domain(lbm::equal_cut(cells, ranks()), {}, ranks());
  std::vector<WorkItem> mine{{{domain.block(rank()).box.lower, {1, 1, 1}}, 1000 * (rank() + 1)}};
  const WeightedCut present = present_cut(MPI_COMM_WORLD, domain, 2, mine);
  double most = 0, all = 0;
  for (int r = 0; r < ranks(); ++r) {
    const double work = 2. * double(domain.block(r).box.cells()) + 1000 * (r + 1);
    most = std::max(most, work), all += work;
  }
  EXPECT_EQ(present.largest, most);
  EXPECT_EQ(present.mean, all / ranks());
}

std::vector<WorkItem> scattered(Int3 cells) {
  WorkMap map(lbm::Domain(lbm::equal_cut(cells, 1), {}, 1));
  std::mt19937 random(3);
  const auto below = [&](int n) { return std::uniform_int_distribution<>(0, n - 1)(random); };
  for (int n = 0; n < 300; ++n)
    map.add(Int3{below(cells.x), below(cells.y), below(cells.z / 3)}, below(90000));
  return map.items();
}

TEST(ForeseenCut, IsTheOneThatTheRanksMake) {
  const Int3 cells{48, 40, 64};
  const std::vector<WorkItem> all = scattered(cells);
  std::vector<WorkItem> mine;
  for (std::size_t k = 0; k < all.size(); ++k)
    if (int(k) % tests::ranks() == tests::rank()) mine.push_back(all[k]);
  const WeightedCut made = weighted_cut(MPI_COMM_WORLD, cells, 10, mine);
  const WorkShares foreseen = foreseen_cut(cells, 10, all, tests::ranks());
  EXPECT_EQ(foreseen.largest, made.largest);
  EXPECT_EQ(foreseen.mean, made.mean);
}

TEST(ForeseenCut, EqualBoxesHaveTheWorkThatLiesInThem) {
  const lbm::Domain domain(lbm::equal_cut({32, 16, 16}, 2), {}, 2);
  const std::vector<WorkItem> item{{{{0, 0, 0}, {8, 8, 8}}, 5000}};
  const WorkShares shares = shares_of(domain, 10, item);
  EXPECT_EQ(shares.largest, 10 * 16 * 16 * 16 + 5000);
  EXPECT_EQ(shares.mean, 10 * 16 * 16 * 16 + 2500);
}

}  // namespace
}  // namespace silt::coupler
