// What one process foresees of a cut is what the ranks then make together.
#include "coupler/balance/weighted_cut.hpp"

#include <gtest/gtest.h>

#include <random>

#include "lbm/equal_cut.hpp"
#include "tests/world.hpp"

namespace silt::coupler {
namespace {

using lbm::Int3;

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
