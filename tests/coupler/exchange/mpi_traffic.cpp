// The counts of traffic.hpp against counts on paper.
#include "coupler/exchange/traffic.hpp"

#include <gtest/gtest.h>

#include <algorithm>

#include "coupler/simulation.hpp"
#include "tests/coupler/case/case_text.hpp"
#include "tests/world.hpp"

namespace silt::coupler::testing {
namespace {

using tests::rank;
using tests::ranks;

TEST(Traffic, CountsMessagesAndTheirBytes) {
  const Traffic before = traffic();
  const int next = (rank() + 1) % ranks(), last = (rank() + ranks() - 1) % ranks();
  const double sent[3] = {};
  double received[3] = {};
  MPI_Request requests[2];
  MPI_Isend(sent, 3, MPI_DOUBLE, next, 0, MPI_COMM_WORLD, &requests[0]);
  MPI_Issend(sent, 0, MPI_DOUBLE, next, 1, MPI_COMM_WORLD, &requests[1]);
  MPI_Recv(received, 3, MPI_DOUBLE, last, 0, MPI_COMM_WORLD, MPI_STATUS_IGNORE);
  MPI_Recv(received, 3, MPI_DOUBLE, last, 1, MPI_COMM_WORLD, MPI_STATUS_IGNORE);
  MPI_Waitall(2, requests, MPI_STATUSES_IGNORE);
  const Traffic now = traffic() - before;
  EXPECT_EQ(now.messages, 2u);
  EXPECT_EQ(now.empty_messages, 1u);
  EXPECT_EQ(now.bytes, 24u);
  EXPECT_EQ(now.blocking_collectives, 0u);
}

TEST(Traffic, ACollectiveBlocksIfItEndsInItsStep) {
  const Traffic before = traffic();
  begin_step_of_traffic();
  MPI_Barrier(MPI_COMM_WORLD);
  const int mine = 1;
  int sum = 0;
  MPI_Request request;
  MPI_Iallreduce(&mine, &sum, 1, MPI_INT, MPI_SUM, MPI_COMM_WORLD, &request);
  MPI_Wait(&request, MPI_STATUS_IGNORE);
  MPI_Ibarrier(MPI_COMM_WORLD, &request);
  for (int done = 0; !done;) MPI_Test(&request, &done, MPI_STATUS_IGNORE);
  MPI_Iallreduce(&mine, &sum, 1, MPI_INT, MPI_SUM, MPI_COMM_WORLD, &request);
  begin_step_of_traffic();
  MPI_Wait(&request, MPI_STATUS_IGNORE);
  MPI_Barrier(MPI_COMM_SELF);
  EXPECT_EQ(sum, ranks());
  const Traffic now = traffic() - before;
  EXPECT_EQ(now.blocking_collectives, ranks() > 1 ? 3u : 0u);
  EXPECT_EQ(now.collectives_under_way, ranks() > 1 ? 1u : 0u);
  EXPECT_EQ(now.messages, 0u);
}

TEST(Traffic, WaitsForALateRankAreWaits) {
  if (ranks() == 1) return;
  const Traffic before = traffic();
  MPI_Barrier(MPI_COMM_WORLD);
  constexpr double late = 0.05;  // seconds
  for (const double begin = MPI_Wtime(); rank() == 0 && MPI_Wtime() < begin + late;)
    ;
  MPI_Barrier(MPI_COMM_WORLD);
  if (rank() > 0) {
    EXPECT_GT((traffic() - before).waited, 0.5 * late);
  }
}

/// A periodic box of fluid: every step sends the populations that cross the sides of a rank's block, five
/// directions a cell of a side, those across an edge once, to each rank beyond a side or an edge.
TEST(Traffic, AStepOfFluidSendsWhatLeavesABlock) {
  CaseText text;
  text.domain = domain_of({16, 16, 16});
  text.shapes = text.bodies = "";
  Simulation simulation = text.start(MPI_COMM_WORLD);
  constexpr int steps = 6;
  for (int i = 0; i < steps; ++i) simulation.step();
  const lbm::Int3 n = simulation.scene().flow->block(0).size;
  const auto beyond = [&](int d) { return std::min(16 / n[d] - 1, 2); };  // ranks, along an axis
  std::uint64_t slots = 0, peers = 0;
  for (int d = 0; d < 3; ++d) {
    const int e = (d + 1) % 3, f = (d + 2) % 3;
    peers += beyond(d) + beyond(d) * beyond(e);
    if (beyond(d) > 0) slots += 2 * 5 * n[e] * n[f];
    if (beyond(d) > 0 && beyond(e) > 0) slots -= 4 * n[f];
  }
  const Traffic& sent = simulation.traffic_in_steps();
  EXPECT_EQ(sent.messages, steps * peers);
  EXPECT_EQ(sent.bytes, steps * slots * sizeof(float));
  EXPECT_EQ(sent.empty_messages, 0u);
  EXPECT_EQ(sent.blocking_collectives, 0u);
}

}  // namespace
}  // namespace silt::coupler::testing
