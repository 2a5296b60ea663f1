// The same bits on any number of ranks: bodies that cross the borders of ranks and touch there all the time.
#include <gtest/gtest.h>

#include <map>

#include "tests/coupler/exchange/exchange_scene.hpp"

namespace silt::coupler {
namespace {

using namespace testing;

/// Runs a scene on all ranks and on one, and compares ids at every step and everything at the end.
void expect_same_as_on_one_rank(const ExchangeScene& scene, std::string_view law, const Blocks& blocks,
                                int steps, double dt) {
  SceneRun<Witness> parallel(MPI_COMM_WORLD, scene, law, blocks), serial(MPI_COMM_SELF, scene, law, blocks);
  const OwnedBodies all = count_owned(MPI_COMM_SELF, serial.bodies());
  std::uint64_t most_sweeps = 0;  // of the rank with most, each step
  for (int i = 0; i < steps; ++i) {
    parallel.advance(dt);
    serial.advance(dt);
    most_sweeps += max_of(MPI_COMM_WORLD, parallel.report.resolver.sweeps);
    ASSERT_EQ(count_owned(MPI_COMM_WORLD, parallel.bodies()), all) << "step " << i;
    if (i % 50 != 0) continue;
    ASSERT_EQ(parallel.hash(), serial.hash()) << "step " << i;
    ASSERT_NO_THROW(check_exchange(parallel.exchange, parallel.bodies(), ExpectedBodies(parallel.bodies())))
        << "step " << i;
  }
  EXPECT_EQ(parallel.hash(), serial.hash());
  EXPECT_EQ(sum_of(MPI_COMM_WORLD, parallel.contacts), serial.contacts);
  EXPECT_EQ(most_sweeps, serial.sweeps);
  EXPECT_TRUE(parallel.exchange.in_order);
  EXPECT_EQ(sum_of(MPI_COMM_WORLD, parallel.exchange.at_first), serial.exchange.at_first);
  EXPECT_EQ(sum_of(MPI_COMM_WORLD, parallel.exchange.at_second), serial.exchange.at_second);
  EXPECT_GT(serial.contacts, std::uint64_t(steps));
  const std::uint64_t migrations = sum_of(MPI_COMM_WORLD, parallel.exchange.counters().migrations);
  const std::uint64_t mixed = sum_of(MPI_COMM_WORLD, parallel.mixed_contacts);
  if (ranks_of(MPI_COMM_WORLD) == 1) return;
  EXPECT_GT(migrations, 20u);
  EXPECT_GT(mixed, 100u);
  EXPECT_GT(sum_of(MPI_COMM_WORLD, parallel.exchange.visitors), 0u);
}

TEST(ParallelBodyExchange, GasInPeriodicBox) {
  expect_same_as_on_one_rank(gas(1), "sffd", {}, 2000, 1);
}
TEST(ParallelBodyExchange, GasOnCubesSeveralARank) {
  expect_same_as_on_one_rank(gas(1), "sffd", {{6, 6, 6}}, 400, 1);
}
TEST(ParallelBodyExchange, GasOnSliversSeveralARank) {
  expect_same_as_on_one_rank(gas(1), "sffd", {{5, 24, 3}}, 400, 1);
}
TEST(ParallelBodyExchange, GasOnOddBlocks) {
  expect_same_as_on_one_rank(gas(1), "sffd", odd_blocks(1), 400, 1);
  expect_same_as_on_one_rank(gas(1), "sffd", odd_blocks(4), 400, 1);
}
TEST(ParallelBodyExchange, GasWithClassicFfd) {
  expect_same_as_on_one_rank(gas(0.8), "ffd", {}, 400, 1);
}
TEST(ParallelBodyExchange, GasWithClassicFfdSeveralBlocksARank) {
  expect_same_as_on_one_rank(gas(0.8), "ffd", {{6, 12, 5}}, 400, 1);
}

/// A quarter as wide as the gas: every body meets its neighbours through both sides, close to its own images.
ExchangeScene ring() {
  const ExchangeScene whole = gas(1);
  ExchangeScene s = whole;
  s.cells = {6, 24, 24};
  s.bodies = {};
  for (std::size_t row = 0; row < whole.bodies.owned; ++row)
    if (whole.bodies.position[row][0] < 6) s.bodies.add(whole.bodies.record(row));
  s.bodies.reindex();
  return s;
}
TEST(ParallelBodyExchange, PeriodicAxisOfOneBlock) {
  expect_same_as_on_one_rank(ring(), "sffd", {{6, 12, 6}}, 700, 1);
}
TEST(ParallelBodyExchange, PeriodicAxisOfTwoBlocks) {
  expect_same_as_on_one_rank(ring(), "sffd", {{3, 12, 12}}, 700, 1);
}

TEST(ParallelBodyExchange, BallLargerThanBlocks) {
  expect_same_as_on_one_rank(planet(), "sffd", {}, 600, 1);
  expect_same_as_on_one_rank(planet(), "sffd", {{6, 6, 6}}, 300, 1);
  expect_same_as_on_one_rank(planet(), "ffd", {{12, 12, 4}}, 300, 1);
  expect_same_as_on_one_rank(planet(), "sffd", odd_blocks(27), 300, 1);
}

/// Falling onto a floor between walls, fixed and moved bodies among them: chains of contacts, impulses
/// remembered.
ExchangeScene heap() {
  ExchangeScene s = gas(0.3, 0.1);
  s.periodic = {true, false, false};
  s.world.gravity = {0.0005, 0.0003, -0.003};
  s.settings.max_sweeps = 8;
  s.bodies.motion[5] = rigid::Motion::fixed;
  s.bodies.set_velocity(5, Vec3::Zero(), Vec3::Zero());
  s.bodies.motion[40] = rigid::Motion::prescribed;
  s.bodies.set_velocity(40, {0.05, 0, 0}, {0, 0.01, 0});
  s.add_walls();
  return s;
}
TEST(ParallelBodyExchange, HeapBetweenWalls) {
  expect_same_as_on_one_rank(heap(), "sffd", {{12, 12, 12}}, 300, 1);
}
TEST(ParallelBodyExchange, HeapOnOddBlocks) {
  expect_same_as_on_one_rank(heap(), "sffd", odd_blocks(3, 6), 300, 1);
}
TEST(ParallelBodyExchange, HeapBetweenWallsClassicFfd) {
  expect_same_as_on_one_rank(heap(), "ffd", {{8, 8, 8}}, 400, 1);
}

/// Most of a heap on a rough floor sleeps; a body that is moved through it wakes what it meets, which falls
/// asleep again.
TEST(ParallelBodyExchange, AHeapThatSleepsAndIsWoken) {
  ExchangeScene s = heap();
  s.periodic = {false, false, false};
  s.world.gravity = {0, 0, -0.003};
  s.world.materials = {{0, 0.6}};
  s.world.sleep = rigid::SleepRule{2e-3, 20};
  s.bodies.set_velocity(40, {0.01, 0, 0}, Vec3::Zero());
  s.bodies.motion[5] = rigid::Motion::free;
  s.bodies.walls = 0;
  for (std::size_t row = s.bodies.size(); row-- > s.bodies.owned;) s.bodies.erase(row);
  s.add_walls();
  for (const Blocks& blocks : {Blocks{{12, 12, 12}}, odd_blocks(3, 6)}) {
    SceneRun<Witness> parallel(MPI_COMM_WORLD, s, "sffd", blocks), serial(MPI_COMM_SELF, s, "sffd", blocks);
    std::map<BodyId, bool> slept;
    std::size_t fell_asleep = 0, woke = 0, most = 0;
    for (int i = 0; i < 1500; ++i) {
      parallel.advance(1);
      serial.advance(1);
      std::size_t now = 0;
      for (std::size_t row = 0; row < serial.bodies().owned; ++row) {
        const bool sleeps = serial.bodies().is_at_rest(row);
        bool& did = slept[serial.bodies().id[row]];
        fell_asleep += sleeps && !did, woke += did && !sleeps, now += sleeps;
        did = sleeps;
      }
      most = std::max(most, now);
      if (i % 50 != 0) continue;
      ASSERT_EQ(parallel.hash(), serial.hash()) << "step " << i;
      ASSERT_NO_THROW(check_exchange(parallel.exchange, parallel.bodies(), ExpectedBodies(parallel.bodies())))
          << "step " << i;
    }
    EXPECT_EQ(parallel.hash(), serial.hash());
    EXPECT_EQ(sum_of(MPI_COMM_WORLD, parallel.contacts), serial.contacts);
    EXPECT_GT(fell_asleep, 60u);
    EXPECT_GT(woke, 20u);
    EXPECT_GT(most, 40u);
  }
}

/// Stacks that begin at rest, all heavier at the top, along the longest axis of the cut and across others.
TEST(ParallelBodyExchange, StacksThatBeginAtRest) {
  ExchangeScene s(0, 0.5);
  s.periodic = {true, true, false};
  s.world.gravity = {0, 0, -0.001};
  const int box = s.shape(rigid::Box{{1, 1, 1}});
  for (BodyId id = 0; id < 22; ++id) s.add(id, box, {6.0 + 12.0 * (id / 11), 6.1, 1.0 + 2.0 * (id % 11)});
  for (const std::size_t heavy : {10, 21}) {
    s.bodies.mass[heavy] *= 100;
    s.bodies.inertia_B[heavy] *= 100;
  }
  s.add_walls();
  for (const Blocks& blocks : {Blocks{}, Blocks{{12, 24, 6}}, odd_blocks(3, 6)}) {
    SceneRun<Witness> parallel(MPI_COMM_WORLD, s, "sffd", blocks), serial(MPI_COMM_SELF, s, "sffd", blocks);
    for (int i = 0; i < 20; ++i) {
      parallel.advance(1);
      serial.advance(1);
      ASSERT_EQ(parallel.hash(), serial.hash()) << "step " << i;
      if (i == 0) {
        EXPECT_GT(serial.report.resolver.sweeps, 10 * s.settings.max_sweeps);
      }
    }
  }
}

}  // namespace
}  // namespace silt::coupler
