#include "parallel/collectives.hpp"

#include <gtest/gtest.h>

#include "parallel/sums_under_way.hpp"
#include "parallel/together.hpp"
#include "tests/world.hpp"

namespace silt::parallel::testing {
namespace {

using tests::rank;
using tests::ranks;

struct Sums {
  std::int64_t count;
  WideSum wide[2];
  struct {
    std::uint64_t rank;
    WideSum negative;
  } inner;
};

/// Each member of a record is summed by itself, 128 bits with their carries and signs among them.
TEST(Collectives, ARecordBecomesTheSumOfEachMember) {
  const __int128 large = (__int128(1) << 100) + 0xffffffff;
  const Sums mine{1, {large, -1}, {std::uint64_t(rank()), -large}};
  SumsUnderWay<Sums> under_way;
  under_way.start(MPI_COMM_WORLD, mine);
  for (const Sums& all : {sum_over_ranks(MPI_COMM_WORLD, mine), under_way.finish()}) {
    EXPECT_EQ(all.count, ranks());
    EXPECT_TRUE(all.wide[0].value() == large * ranks());
    EXPECT_TRUE(all.wide[1].value() == -ranks());
    EXPECT_EQ(all.inner.rank, std::uint64_t(ranks() * (ranks() - 1) / 2));
    EXPECT_TRUE(all.inner.negative.value() == -large * ranks());
  }
  struct {
    __int128 one, two[2];
  } numbers{large, {-large, 3}};
  numbers = sum_over_ranks(MPI_COMM_WORLD, numbers);
  EXPECT_TRUE(numbers.one == large * ranks() && numbers.two[0] == -numbers.one &&
              numbers.two[1] == 3 * ranks());
  EXPECT_EQ(sum_of_ranks_before(MPI_COMM_WORLD, std::int64_t{2}), 2 * rank());
}

TEST(Collectives, TheLargestOfANumberARecordAndAnArray) {
  const double mine = rank();
  struct {
    double up, down;
  } record{mine, -mine};
  double array[] = {mine, -mine};
  EXPECT_EQ(max_over_ranks(MPI_COMM_WORLD, mine), ranks() - 1);
  record = max_over_ranks(MPI_COMM_WORLD, record);
  EXPECT_TRUE(record.up == ranks() - 1 && record.down == 0);
  max_over_ranks(MPI_COMM_WORLD, array);
  EXPECT_TRUE(array[0] == ranks() - 1 && array[1] == 0);
}

TEST(Collectives, WhatOneHasAllHear) {
  std::string text = rank() == ranks() - 1 ? "from the last" : "";
  broadcast(MPI_COMM_WORLD, text, ranks() - 1);
  EXPECT_EQ(text, "from the last");
}

TEST(Collectives, GatheredValuesLieInTheOrderOfRanks) {
  const std::vector<int> mine(std::size_t(rank() % 3), rank());
  std::vector<std::size_t> first;
  const auto all = gathered(MPI_COMM_WORLD, std::span(mine), Told::everybody, &first);
  ASSERT_EQ(first.size(), std::size_t(ranks() + 1));
  for (int r = 0; r < ranks(); ++r) {
    ASSERT_EQ(first[r + 1] - first[r], std::size_t(r % 3));
    for (std::size_t k = first[r]; k < first[r + 1]; ++k) EXPECT_EQ(all[k], r);
  }
  const auto told = gathered(MPI_COMM_WORLD, std::span(mine), Told::rank_0);
  EXPECT_EQ(told, rank() == 0 ? all : std::vector<int>());
}

TEST(Together, TheFirstRankThatFailedSpeaks) {
  const auto said = [](int first) {
    try {
      together(MPI_COMM_WORLD, [&] {
        if (rank() >= first) throw std::runtime_error("rank " + std::to_string(rank()));
      });
    } catch (const CommonError& error) {
      return std::to_string(error.rank) + ": " + error.what();
    }
    return std::string("nothing");
  };
  EXPECT_EQ(said(ranks()), "nothing");
  const std::string last = std::to_string(ranks() - 1);
  EXPECT_EQ(said(ranks() - 1), last + ": rank " + last);
  EXPECT_EQ(said(0), "0: rank 0");
  EXPECT_EQ(text_of_first(MPI_COMM_WORLD, rank() > 0 ? std::to_string(rank()) : ""), ranks() > 1 ? "1" : "");
}

}  // namespace
}  // namespace silt::parallel::testing
