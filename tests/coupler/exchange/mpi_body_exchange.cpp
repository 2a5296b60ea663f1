// Bodies that cross the borders of ranks and touch there all the time have the same bits on any number of
// ranks, and in any order of rows.
#include <gtest/gtest.h>

#include <algorithm>
#include <numeric>
#include <random>

#include "coupler/exchange/parallel_body_exchange.hpp"
#include "tests/coupler/exchange/exchange_scene.hpp"
#include "tests/rigid/shapes/meshes.hpp"
#include "tests/world.hpp"

namespace silt::coupler {
namespace {

using namespace testing;
using tests::rank;
using tests::ranks;

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
  EXPECT_EQ(serial.impact_sweeps > 0, scene.settings.impact_sweeps > 0);
  const std::uint64_t migrations = sum_of(MPI_COMM_WORLD, parallel.exchange.counters().migrations);
  const std::uint64_t mixed = sum_of(MPI_COMM_WORLD, parallel.mixed_contacts);
  if (ranks_of(MPI_COMM_WORLD) == 1) return;
  EXPECT_GT(migrations, 20u);
  EXPECT_GT(mixed, 100u);
  EXPECT_GT(sum_of(MPI_COMM_WORLD, parallel.exchange.visitors), 0u);
}

ExchangeScene elastic_gas() {
  return gas(1);
}
ExchangeScene lossy_gas() {
  return gas(0.8);
}
/// A quarter as wide as the gas: every body meets its neighbours through both sides, close to its own images.
ExchangeScene ring() {
  ExchangeScene s = thinned(gas(1), [](const Vec3& x) { return x[0] < 6; });
  s.cells = {6, 24, 24};
  return s;
}
/// Falling, with few sweeps to solve for contacts: what is added up in another order would show.
ExchangeScene falling() {
  ExchangeScene s = gas(0.3, 0.1);
  s.periodic = {true, false, false};
  s.world.gravity = {0.0005, 0.0003, -0.003};
  s.settings.max_sweeps = 8;
  s.bodies.motion[5] = rigid::Motion::fixed;
  s.bodies.set_velocity(5, Vec3::Zero(), Vec3::Zero());
  s.bodies.motion[40] = rigid::Motion::prescribed;
  s.bodies.set_velocity(40, {0.05, 0, 0}, {0, 0.01, 0});
  return s;
}
/// Falling onto a floor between walls, fixed and moved bodies among them: chains of contacts, impulses
/// remembered.
ExchangeScene heap() {
  ExchangeScene s = falling();
  s.add_walls();
  return s;
}
ExchangeScene heap_by_bullet() {
  ExchangeScene s = heap();
  s.broad_phase = "bullet";
  return s;
}
ExchangeScene heap_by_fcl() {
  ExchangeScene s = heap();
  s.broad_phase = "fcl";
  return s;
}
/// The heap's bodies of two materials, by their ids.
ExchangeScene heap_of(const rigid::Material& equals, const rigid::Material& unequals) {
  ExchangeScene s = heap();
  s.world.materials = {equals, unequals, unequals, equals};
  s.world.material_count = 2;
  for (std::size_t row = 0; row < s.bodies.owned; ++row) s.bodies.material[row] = s.bodies.id[row] % 3 == 0;
  return s;
}
/// Groups of contacts with friction, without, and of both come about.
ExchangeScene partly_slippery() {
  return heap_of({0.4, 0}, {0.4, 0.5});
}
/// Of pairs that meet in one body those of the larger restitution collide first.
ExchangeScene heap_of_impacts() {
  ExchangeScene s = heap_of({0.9, 0.2}, {0.6, 0.2});
  s.settings.impact_sweeps = 60;
  return s;
}
/// Bodies that stick to each other and to the walls.
ExchangeScene sticky() {
  ExchangeScene s = heap();
  rigid::Material& m = s.world.materials[0];
  m.restitution = 0, m.cohesion = 0.2, m.hamaker = 1e-6, m.hamaker_gap = 1e-3;
  return s;
}
rigid::Compound star() {
  rigid::Compound star;
  for (const Vec3& axis : {Vec3(1, 0, 0), Vec3(0, 1, 0), Vec3(0, 0, 1)})
    star.parts.push_back(
        {rigid::Capsule{0.8, 1.2}, {Vec3::Zero(), rigid::rotation_between(Vec3::UnitZ(), axis)}});
  return star;
}
/// A turning plate, prescribed, much larger than a rank's part, with a beam across it that sweeps along what
/// falls on it.
ExchangeScene carousel() {
  ExchangeScene s = thinned(falling(), [](const Vec3& x) { return x[2] > 6; });
  rigid::Compound plate;
  plate.parts = {{rigid::Box{{8, 8, 0.5}}, {}},
                 {rigid::Box{{7.6, 0.5, 1}}, {Vec3(0, 0, 1.5), rigid::Quat::Identity()}}};
  s.add(5000, s.shape(plate), {12, 12, 3}, {0.02, 0, 0}, {0, 0, 0.02});
  s.bodies.motion[s.bodies.row_of(5000)] = rigid::Motion::prescribed;
  s.add_walls();
  return s;
}
/// Rings and cubes of triangles, balls, boxes, capsules and stars on a floor of triangles, with a paddle of
/// triangles that turns across a periodic border.
ExchangeScene meshes_on_a_floor() {
  using namespace rigid::testing;
  ExchangeScene s(0.4, 0.3);
  s.periodic = {true, true, false};
  s.world.gravity = {0, 0, -0.003};
  s.settings.max_sweeps = 6;
  const int shapes[] = {s.shape(solid_of(torus_mesh(1.8, 0.6, 10, 6))),
                        s.shape(solid_of(cuboid_mesh(Vec3::Constant(-1.6), Vec3::Constant(1.6)))),
                        s.shape(rigid::Sphere{1.6}),
                        s.shape(rigid::Box{{1.6, 1.2, 2}}),
                        s.shape(rigid::Capsule{1, 1.6}),
                        s.shape(star())};
  for (int k = 0; k < 36; ++k) add_flying(s, k, shapes[k % 6], 0.1, 6);
  s.add_walls();
  const rigid::Quat upright = rigid::Quat::Identity();
  rigid::PrescribedMotion turns;
  turns.angular_velocity = {0, 0, 0.01};
  add_wall(s.bodies, s.world,
           {solid_of(random_slab(72, 4, 6, 3)), {{-24, -24, 4}, upright}, Vec3::UnitZ(), 0, {}});
  add_wall(s.bodies, s.world,
           {solid_of(cuboid_mesh({-6, -0.8, -1.6}, {6, 0.8, 1.6})),
            {{1.5, 12, 5.7}, upright},
            Vec3::UnitZ(),
            0,
            turns});
  return s;
}

struct ExchangeRun {
  const char* name;
  ExchangeScene (*scene)();
  const char* law;
  Blocks blocks;
  int steps;
};
const ExchangeRun exchange_runs[] = {
    {"GasInPeriodicBox", elastic_gas, "sffd", {}, 800},
    {"GasOnCubesSeveralARank", elastic_gas, "sffd", {{6, 6, 6}}, 250},
    {"GasOnSliversSeveralARank", elastic_gas, "sffd", {{5, 24, 3}}, 250},
    {"GasOnOddBlocks", elastic_gas, "sffd", odd_blocks(1), 250},
    {"GasOnOddBlocksSeveralARank", elastic_gas, "sffd", odd_blocks(4), 250},
    {"GasWithClassicFfd", lossy_gas, "ffd", {}, 250},
    {"GasWithClassicFfdSeveralBlocksARank", lossy_gas, "ffd", {{6, 12, 5}}, 250},
    {"PeriodicAxisOfOneBlock", ring, "sffd", {{6, 12, 6}}, 200},
    {"PeriodicAxisOfTwoBlocks", ring, "sffd", {{3, 12, 12}}, 200},
    {"BallAsLargeAsBlocks", planet, "sffd", {}, 200},
    {"BallLargerThanBlocks", planet, "sffd", {{6, 6, 6}}, 200},
    {"BallLargerThanBlocksWithFfd", planet, "ffd", {{12, 12, 4}}, 200},
    {"BallLargerThanOddBlocks", planet, "sffd", odd_blocks(27), 200},
    {"HeapBetweenWalls", heap, "sffd", {{12, 12, 12}}, 200},
    {"HeapOnOddBlocks", heap, "sffd", odd_blocks(3, 6), 200},
    {"HeapBetweenWallsClassicFfd", heap, "ffd", {{8, 8, 8}}, 250},
    {"HeapByBullet", heap_by_bullet, "sffd", {}, 200},
    {"HeapByFcl", heap_by_fcl, "sffd", {}, 200},
    {"PartlySlippery", partly_slippery, "sffd", {}, 200},
    {"HeapOfImpacts", heap_of_impacts, "sffd", {}, 200},
    {"Sticky", sticky, "sffd", {}, 200},
    {"PlateLargerThanBlocks", carousel, "sffd", {{6, 12, 6}}, 250},
    {"MeshesOnAFloor", meshes_on_a_floor, "sffd", {}, 200}};

class BodyExchange : public ::testing::TestWithParam<ExchangeRun> {};
TEST_P(BodyExchange, IsAsOnOneRank) {
  const ExchangeRun& run = GetParam();
  expect_same_as_on_one_rank(run.scene(), run.law, run.blocks, run.steps, 1);
}
/// Without the exchange that sorts them.
TEST_P(BodyExchange, OrderOfRowsDoesNotMatter) {
  if (ranks() > 1) return;
  ExchangeScene s = GetParam().scene();
  SceneRun<> sorted(MPI_COMM_SELF, s, GetParam().law);
  const rigid::BodySet ordered = s.bodies;
  std::vector<std::size_t> rows(ordered.owned);
  std::iota(rows.begin(), rows.end(), 0);
  std::shuffle(rows.begin(), rows.end(), std::mt19937(2));
  for (std::size_t k = 0; k < rows.size(); ++k) s.bodies.erase(0);
  for (std::size_t k = 0; k < rows.size(); ++k) s.bodies.insert(k, ordered.record(rows[k]));
  s.bodies.reindex();
  rigid::BodyExchange exchange(s.extent());
  const auto resolver = s.resolver(GetParam().law);
  rigid::RigidStep step(s.world, *sorted.backend, *resolver, exchange);
  for (int i = 0; i < std::min(GetParam().steps, 250); ++i) sorted.advance(), step(s.bodies, 1);
  EXPECT_EQ(records_hash(MPI_COMM_SELF, s.bodies), sorted.hash());
}
INSTANTIATE_TEST_SUITE_P(Parallel, BodyExchange, ::testing::ValuesIn(exchange_runs),
                         [](const auto& info) { return info.param.name; });

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

// ---- bodies saved on any ranks come to their owners, each once and with all it has ----

/// Returns as many impulses as the id says, unlike any other body's.
std::vector<rigid::StoredImpulse> impulses(BodyId id) {
  std::vector<rigid::StoredImpulse> list;
  for (BodyId k = 0; k < id % 4; ++k)
    list.push_back(
        {id + k + 1, {std::int8_t(k % 3 - 1), 1, 0}, id << 8 | k, Vec3(0.1 * double(id), -0.0, k)});
  return list;
}

/// All bodies of a scene, with impulses, as one rank alone has them.
rigid::BodySet with_impulses(const ExchangeScene& scene) {
  rigid::BodySet bodies = scene.bodies;
  for (std::size_t row = 0; row < bodies.owned; ++row) bodies.stored_impulses[row] = impulses(bodies.id[row]);
  return bodies;
}

/// Saves every body of the scene on the rank that a rule names, and sends all home.
template <class Rule>
rigid::BodySet sent(const ExchangeScene& scene, const Holders& holders, std::size_t at_once,
                    Rule&& saved_on) {
  const rigid::BodySet all = with_impulses(scene);
  SavedBodies saved;
  for (std::size_t row = 0; row < all.owned; ++row)
    if (saved_on(row) == rank()) {
      saved.records.push_back(all.record(row));
      saved.impulses.push_back(all.stored_impulses[row]);
    }
  rigid::BodySet here;
  parallel::Messages messages(MPI_COMM_WORLD);
  distribute_to_owners(messages, holders, saved, here, at_once);
  return here;
}

TEST(SendHome, every_body_comes_whole_to_the_rank_of_its_centre) {
  const ExchangeScene scene = gas(1);
  const lbm::Domain domain(scene.cells, scene.sides(), {}, ranks());
  const Holders holders(domain, 0);
  const std::uint64_t expected = records_hash(MPI_COMM_SELF, with_impulses(scene));
  const std::size_t n = scene.bodies.owned;
  for (const std::size_t at_once : {std::size_t{5}, n, std::size_t{1} << 14})
    for (const int deal : {0, 1, 2}) {
      const auto here = sent(scene, holders, at_once, [&](std::size_t row) {
        return deal == 0 ? int(row % ranks()) : deal == 1 ? int(row * ranks() / n) : ranks() - 1;
      });
      EXPECT_EQ(count_owned(MPI_COMM_WORLD, here), count_owned(MPI_COMM_SELF, scene.bodies));
      EXPECT_EQ(records_hash(MPI_COMM_WORLD, here), expected) << "deal " << deal << ", at once " << at_once;
      for (std::size_t row = 0; row < here.owned; ++row) {
        EXPECT_EQ(holders.rank_at(here.position[row]), rank());
        EXPECT_TRUE(row == 0 || here.id[row - 1] < here.id[row]);
        EXPECT_EQ(here.row_of(here.id[row]), row);
      }
    }
}

TEST(SendHome, no_bodies_at_all) {
  const ExchangeScene scene(1, 0);
  const lbm::Domain domain(scene.cells, scene.sides(), {}, ranks());
  const auto here = sent(scene, Holders(domain, 0), 1, [](std::size_t) { return 0; });
  EXPECT_EQ(here.size(), 0u);
}

}  // namespace
}  // namespace silt::coupler
