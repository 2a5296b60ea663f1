// Messages, collectives, and the count of what they send.
#include <gtest/gtest.h>

#include "parallel/collectives.hpp"
#include "parallel/messages.hpp"
#include "parallel/pending_sums.hpp"
#include "parallel/together.hpp"
#include "parallel/traffic.hpp"
#include "tests/world.hpp"

namespace silt::parallel::testing {
namespace {

using tests::rank;
using tests::ranks;

/// In a round rank `from` tells rank `to` so many numbers, that say who they are from.
std::size_t length_of(int from, int to, int round) {
  const bool long_one = from == 0 && to == ranks() - 1 && round == 1;
  return long_one ? 400'000 : std::size_t((from + 2 * to + round) % 3);
}
bool speaks(int from, int to, int round) {
  return (from + to + round) % 2 == 0;
}

/// Nobody knows who writes to it: in each round some ranks write to some, themselves among them, one message
/// longer than a piece, some empty; what comes is what was sent, by the ranks it is from.
TEST(Messages, UnannouncedOnesComeWholeAndInTheOrderOfRanks) {
  Messages messages(MPI_COMM_WORLD);
  for (int round = 0; round < 3; ++round) {
    for (int to = ranks() - 1; to >= 0; --to)
      if (speaks(rank(), to, round))
        for (std::size_t n = length_of(rank(), to, round), k = (messages.to(to), 0); k < n; ++k)
          put(messages.to(to), std::array<double, 1>{double(rank()) + 1e-6 * double(k)});
    messages.exchange_sparse();
    auto next = messages.received().begin();
    for (int from = 0; from < ranks(); ++from) {
      if (!speaks(from, rank(), round)) continue;
      ASSERT_NE(next, messages.received().end()) << round;
      EXPECT_EQ(next->rank, from);
      ASSERT_EQ(next->bytes.size(), length_of(from, rank(), round) * sizeof(double));
      ByteReader reader(next->bytes);
      for (std::size_t k = 0; !reader.done(); ++k)
        ASSERT_EQ(reader.read<double>(), double(from) + 1e-6 * double(k));
      ++next;
    }
    EXPECT_EQ(next, messages.received().end()) << round;
  }
}

TEST(Messages, PartnersHearOneAnother) {
  Messages messages(MPI_COMM_WORLD);
  std::vector<int> others;
  for (int r = 0; r < ranks(); ++r)
    if (r != rank()) others.push_back(r);
  for (const int to : others)
    if (messages.to(to); to > rank()) put(messages.to(to), rank());
  messages.exchange_with(others);
  ASSERT_EQ(messages.received().size(), others.size());
  for (std::size_t k = 0; k < others.size(); ++k) {
    EXPECT_EQ(messages.received()[k].rank, others[k]);
    EXPECT_EQ(messages.received()[k].bytes.size(), others[k] < rank() ? sizeof(int) : 0);
  }
}

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
  PendingSums<Sums> under_way;
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
  const auto all = gathered(MPI_COMM_WORLD, std::span(mine), GatherTo::all_ranks, &first);
  ASSERT_EQ(first.size(), std::size_t(ranks() + 1));
  for (int r = 0; r < ranks(); ++r) {
    ASSERT_EQ(first[r + 1] - first[r], std::size_t(r % 3));
    for (std::size_t k = first[r]; k < first[r + 1]; ++k) EXPECT_EQ(all[k], r);
  }
  const auto told = gathered(MPI_COMM_WORLD, std::span(mine), GatherTo::root);
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

TEST(Traffic, CountsMessagesAndTheirBytes) {
  const Traffic before = traffic();
  const int next = (rank() + 1) % ranks(), last = (rank() + ranks() - 1) % ranks();
  const double sent[3] = {};
  double received[3] = {};
  Transfers transfers(MPI_COMM_WORLD, 0);
  transfers.receive(last, std::span<double>(received));
  transfers.receive(last, std::span<double>(received).first(0));
  transfers.send(next, std::span<const double>(sent));
  transfers.send(next, std::span<const double>());
  transfers.wait();
  EXPECT_EQ(transfers.bytes_received(0), sizeof sent);
  const Traffic now = traffic() - before;
  EXPECT_EQ(now.messages, 2u);
  EXPECT_EQ(now.empty_messages, 1u);
  EXPECT_EQ(now.bytes, 24u);
  EXPECT_EQ(now.blocking_collectives, 0u);
}

TEST(Traffic, ACollectiveBlocksIfItEndsInItsStep) {
  const Traffic before = traffic();
  Messages messages(MPI_COMM_WORLD);
  begin_step_of_traffic();
  EXPECT_EQ(sum_over_ranks(MPI_COMM_WORLD, std::int64_t{1}), ranks());
  PendingSums<std::int64_t> sum;
  sum.start(MPI_COMM_WORLD, 1);
  EXPECT_EQ(sum.finish(), ranks());
  messages.exchange_sparse();
  sum.start(MPI_COMM_WORLD, 2);
  begin_step_of_traffic();
  EXPECT_EQ(sum.finish(), 2 * ranks());
  EXPECT_EQ(sum_over_ranks(MPI_COMM_SELF, std::int64_t{1}), 1);
  const Traffic now = traffic() - before;
  EXPECT_EQ(now.blocking_collectives, ranks() > 1 ? 3u : 0u);
  EXPECT_EQ(now.collectives_under_way, ranks() > 1 ? 1u : 0u);
  EXPECT_EQ(now.messages, 0u);
}

TEST(Traffic, WaitsForALateRankAreWaits) {
  if (ranks() == 1) return;
  const Traffic before = traffic();
  sum_over_ranks(MPI_COMM_WORLD, std::int64_t{1});
  constexpr double late = 0.05;  // seconds
  for (const double begin = MPI_Wtime(); rank() == 0 && MPI_Wtime() < begin + late;)
    ;
  sum_over_ranks(MPI_COMM_WORLD, std::int64_t{1});
  if (rank() > 0) {
    EXPECT_GT((traffic() - before).waited, 0.5 * late);
  }
}

}  // namespace
}  // namespace silt::parallel::testing
