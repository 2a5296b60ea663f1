// The counts of traffic.hpp against counts on paper.
#include "parallel/traffic.hpp"

#include <gtest/gtest.h>

#include "parallel/messages.hpp"
#include "parallel/sums_under_way.hpp"
#include "parallel/transfers.hpp"
#include "tests/world.hpp"

namespace silt::parallel::testing {
namespace {

using tests::rank;
using tests::ranks;

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
  SumsUnderWay<std::int64_t> sum;
  sum.start(MPI_COMM_WORLD, 1);
  EXPECT_EQ(sum.finish(), ranks());
  messages.unannounced();
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
