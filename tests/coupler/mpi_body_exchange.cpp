// The same bits on any number of ranks: bodies that cross the borders of ranks and touch there all the time.
#include <gtest/gtest.h>

#include "exchange_scene.hpp"

namespace silt::coupler {
namespace {

using namespace testing;

/// Runs a scene on all ranks and on one, and compares ids at every step and everything at the end.
void expect_same_as_on_one_rank(const Scene& scene, std::string_view law, Blocks blocks, int steps,
                                double dt) {
  Run<> parallel(MPI_COMM_WORLD, scene, law, blocks), serial(MPI_COMM_SELF, scene, law, blocks);
  const OwnedBodies all = count_owned(MPI_COMM_SELF, serial.bodies());
  for (int i = 0; i < steps; ++i) {
    parallel.advance(dt);
    serial.advance(dt);
    ASSERT_EQ(count_owned(MPI_COMM_WORLD, parallel.bodies()), all) << "step " << i;
    if (i % 50 != 0) continue;
    ASSERT_EQ(parallel.hash(), serial.hash()) << "step " << i;
    ASSERT_NO_THROW(check_bodies(parallel.exchange, parallel.bodies())) << "step " << i;
  }
  EXPECT_EQ(parallel.hash(), serial.hash());
  EXPECT_EQ(sum_of(MPI_COMM_WORLD, parallel.contacts), serial.contacts);
  EXPECT_EQ(parallel.sweeps, serial.sweeps);
  EXPECT_GT(serial.contacts, std::uint64_t(steps));
  const std::uint64_t migrations = sum_of(MPI_COMM_WORLD, parallel.exchange.counters().migrations);
  const std::uint64_t mixed = sum_of(MPI_COMM_WORLD, parallel.mixed_contacts);
  if (ranks_of(MPI_COMM_WORLD) == 1) return;
  EXPECT_GT(migrations, 100u);
  EXPECT_GT(mixed, 100u);
}

TEST(BodyExchange, GasOfPeriodicBox) {
  expect_same_as_on_one_rank(gas(1), "sffd", {}, 2000, 1);
}

}  // namespace
}  // namespace silt::coupler
