// Single situations of exchanges are checked one by one: who holds what, and what each exchange carries.
#include <gtest/gtest.h>

#include <set>

#include "rigid/shapes/shape.hpp"
#include "tests/coupler/exchange/exchange_scene.hpp"
#include "tests/world.hpp"

namespace silt::coupler {
namespace {

using namespace testing;
using rigid::FixedVec3;
using tests::rank;
using tests::ranks;

class Recording : public ParallelBodyExchange {
 public:
  using ParallelBodyExchange::ParallelBodyExchange;
  std::vector<rigid::Contact> found, known;  // by this rank; of its bodies
  std::size_t visitors = 0;
  void exchange_contacts(rigid::BodySet& bodies, std::vector<rigid::Contact>& contacts) override {
    found = contacts;
    ParallelBodyExchange::exchange_contacts(bodies, contacts);
    known = contacts;
    visitors = bodies.visitors;
  }
};

/// Four columns of blocks around the line x = y = 12.
Blocks columns() {
  return ranks() <= 4 ? Blocks{{12, 12, 24}} : Blocks{{12, 12, 12}};
}

/// The paper's Figure 2: a contact between bodies of two ranks whose point lies on a third.
ExchangeScene figure_2() {
  ExchangeScene s(0.5, 0.3);
  s.periodic = {false, false, false};
  s.add(3, s.shape(rigid::Sphere{3.58}), {11, 8, 6}, {0.04, 0.1, 0}, {0, 0, 0.02});
  s.add(8, s.shape(rigid::Sphere{5.37}), {15, 16, 6}, {-0.02, -0.03, 0.01});
  s.add_walls();
  return s;
}

TEST(BodyExchangeTies, ContactOfTwoRanksOnAThird) {
  SceneRun<Recording> run(MPI_COMM_WORLD, figure_2(), "sffd", columns());
  SceneRun<Recording> serial(MPI_COMM_SELF, figure_2(), "sffd", columns());
  run.advance();
  serial.advance();
  const auto between_bodies = [](const std::vector<rigid::Contact>& contacts) {
    return std::count_if(contacts.begin(), contacts.end(),
                         [](const auto& c) { return !rigid::is_wall(c.b); });
  };
  const int first = run.exchange.rank_at({11, 8, 6}), second = run.exchange.rank_at({15, 16, 6});
  ASSERT_EQ(between_bodies(serial.exchange.known), 1);
  EXPECT_EQ(sum_of(MPI_COMM_WORLD, between_bodies(run.exchange.found)), 1u) << "found by one rank only";
  const bool owner = rank() == first || rank() == second;
  EXPECT_EQ(between_bodies(run.exchange.known), owner ? 1 : 0);
  if (ranks() >= 4) {
    const int third = run.exchange.rank_at({12.6, 11.2, 6});
    EXPECT_EQ(std::set<int>({first, second, third}).size(), 3u);
    EXPECT_EQ(between_bodies(run.exchange.found), rank() == third ? 1 : 0);
    EXPECT_EQ(run.exchange.visitors, rank() == second ? 1u : 0u);  // the small ball does not reach so far
  }
  EXPECT_EQ(run.hash(), serial.hash());
  for (const BodyId id : {3, 8}) {  // each owner solved it for itself, to the same bits
    const std::size_t row = run.bodies().row_of(id), there = serial.bodies().row_of(id);
    if (row >= run.bodies().owned) continue;
    ASSERT_EQ(run.bodies().stored_impulses[row].size(), 1u);
    EXPECT_EQ(run.bodies().stored_impulses[row][0].impulse,
              serial.bodies().stored_impulses[there][0].impulse);
    EXPECT_NE(run.bodies().stored_impulses[row][0].impulse, Vec3::Zero());
  }
  EXPECT_EQ(run.bodies().visitors, 0u) << "visitors stay for one step";
}

TEST(BodyExchangeTies, OwnerAndCopiesAreEqual) {
  SceneRun<> run(MPI_COMM_WORLD, figure_2(), "sffd", columns());
  for (int i = 0; i < 5; ++i) {
    run.advance();
    EXPECT_NO_THROW(check_exchange(run.exchange, run.bodies(), ExpectedBodies(run.bodies())));
    std::uint64_t held[2] = {};
    for (const BodyId id : {3, 8}) {
      const std::size_t row = run.bodies().row_of(id);
      const bool holds = row < run.bodies().first_wall();
      held[id == 8] = sum_of(MPI_COMM_WORLD, holds);
    }
    if (ranks() == 4) {
      EXPECT_EQ(held[0], 2u);
      EXPECT_EQ(held[1], 4u);
    }
  }
}

TEST(BodyExchangeTies, HoldersAreThoseWhoseGrownBlocksTheBoxMeets) {
  ExchangeScene scene(0, 0);
  const int shapes[] = {scene.shape(rigid::Sphere{1.5}), scene.shape(rigid::Sphere{9}),
                        scene.shape(rigid::Sphere{14}), scene.shape(rigid::Box{{0.5, 4, 1}}),
                        scene.shape(rigid::Capsule{0.5, 6})};
  std::mt19937 random(1);
  std::uniform_real_distribution<> u(-1, 1);
  for (const std::array<bool, 3> periodic : {std::array{true, true, true}, std::array{false, true, false}})
    for (const Blocks& blocks : {Blocks{}, Blocks{{6, 6, 6}}, Blocks{{24, 5, 3}}, Blocks{{2, 24, 24}},
                                 odd_blocks(1), odd_blocks(5, 1)}) {
      scene.periodic = periodic;
      const double rim = 1.25;
      const lbm::Domain domain(blocks.cut(scene.cells, ranks()), scene.sides(), ranks());
      const ParallelBodyExchange exchange(MPI_COMM_WORLD, domain, scene.world, rim);
      for (int trial = 0; trial < 400; ++trial) {
        const int shape = shapes[trial % 5];
        const rigid::Pose pose{Vec3(12, 12, 12) + 11.9 * Vec3(u(random), u(random), u(random)),
                               rigid::Quat(u(random), u(random), u(random), u(random)).normalized()};
        const rigid::BoundingBox box = rigid::bounding_box(scene.world.shapes[shape], pose);
        std::set<int> expected{
            domain.rank_at(lbm::Int3{int(pose.position[0]), int(pose.position[1]), int(pose.position[2])})};
        EXPECT_EQ(exchange.rank_at(pose.position), *expected.begin());
        for (int b = 0; b < domain.blocks(); ++b) {
          const lbm::BlockPlace block = domain.block(b);
          bool meets = true;
          for (int d = 0; d < 3; ++d) {
            bool along = false;
            for (int image = periodic[d] ? -2 : 0; image <= (periodic[d] ? 2 : 0); ++image) {
              const double low = box.lower[d] + 24 * image, high = box.upper[d] + 24 * image;
              along |= low < block.box.lower[d] + block.box.size[d] + rim && high > block.box.lower[d] - rim;
            }
            meets &= along;
          }
          if (meets) expected.insert(block.rank);
        }
        ASSERT_EQ(exchange.holders(shape, pose), std::vector<int>(expected.begin(), expected.end()))
            << "shape " << shape << " at " << pose.position.transpose();
      }
    }
}

TEST(BodyExchangeTies, OwnerOfPointsOutsideAndOnBorders) {
  ExchangeScene scene(0, 0);
  scene.periodic = {true, false, true};
  const lbm::Domain domain(scene.cells, scene.sides(), lbm::Int3{6, 6, 6}, ranks());
  const ParallelBodyExchange exchange(MPI_COMM_WORLD, domain, scene.world, 1);
  EXPECT_EQ(exchange.rank_at({24, 3, 3}), domain.rank_at({0, 3, 3}));
  EXPECT_EQ(exchange.rank_at({-1e-18, 3, 3}), domain.rank_at({0, 3, 3}));  // rounds to the period, which is 0
  EXPECT_EQ(exchange.rank_at({-0.5, 3, 49}), domain.rank_at({23, 3, 1}));
  EXPECT_EQ(exchange.rank_at({3, -0.5, 3}), domain.rank_at({3, 0, 3}));
  EXPECT_EQ(exchange.rank_at({3, 1e9, 3}), domain.rank_at({3, 23, 3}));
  EXPECT_EQ(exchange.rank_at({6, 6, 6}), domain.rank_at({6, 6, 6}));
  EXPECT_EQ(exchange.rank_at({std::nextafter(6.0, 0.0), 6, 6}), domain.rank_at({5, 6, 6}));
  EXPECT_TRUE(sum_of(MPI_COMM_WORLD, exchange.owns_contact_at({11, 12, 13})) == 1);
}

/// Between steps: bodies set down anywhere, pushed and given velocities.
TEST(BodyExchangeTies, PosesAndVelocitiesSetBetweenSteps) {
  SceneRun<> run(MPI_COMM_WORLD, gas(1), "sffd", Blocks{{6, 6, 12}}), serial(MPI_COMM_SELF, gas(1));
  const auto meddle = [](rigid::BodySet& bodies, int step) {
    std::mt19937 random(step);
    std::uniform_real_distribution<> u(-1, 1);
    const auto some = [&] { return bodies.row_of(1000 - 7 * (random() % 64)); };
    const auto vector = [&] { return Vec3(u(random), u(random), u(random)); };
    for (int k = 0; k < 6; ++k) {
      const std::size_t row = some();
      const Vec3 force = vector();
      if (row < bodies.owned) bodies.add_force(row, force);
    }
    for (int k = 0; k < 6; ++k) {
      const std::size_t row = some();
      const Vec3 x = Vec3(12, 12, 12) + 30 * vector(), v = 0.2 * vector();
      if (row >= bodies.owned) continue;
      if (k % 2) bodies.set_pose(row, {x, bodies.orientation[row]});
      bodies.set_velocity(row, v, Vec3::Zero());
    }
  };
  for (int step = 0; step < 120; ++step) {
    meddle(run.bodies(), step);
    meddle(serial.bodies(), step);
    for (auto* r : {&run, &serial}) r->exchange.relocate(r->bodies());
    ASSERT_NO_THROW(check_exchange(run.exchange, run.bodies(), ExpectedBodies(run.bodies())));
    ASSERT_EQ(run.hash(), serial.hash()) << "step " << step;
    run.advance();
    serial.advance();
    ASSERT_EQ(run.hash(), serial.hash()) << "step " << step;
  }
  if (ranks() > 1) {
    EXPECT_GT(sum_of(MPI_COMM_WORLD, run.exchange.counters().migrations), 50u);
  }
}

/// A contact is looked for where bodies are after half a step, by ranks that must have copies by then.
TEST(BodyExchangeTies, FastBodiesAreKnownWhereTheyCome) {
  SceneRun<> run(MPI_COMM_WORLD, gas(1, 1.2), "sffd", Blocks{{6, 6, 12}}), serial(MPI_COMM_SELF, gas(1, 1.2));
  for (int step = 0; step < 40; ++step) {
    run.advance();
    serial.advance();
    ASSERT_EQ(run.hash(), serial.hash()) << "step " << step;
  }
}

/// Set down on the wrong rank, with all that belongs to it.
TEST(BodyExchangeTies, HandoverCarriesEverything) {
  ExchangeScene scene(0.5, 0);
  const int ball = scene.shape(rigid::Sphere{1});
  SceneRun<> run(MPI_COMM_WORLD, scene, "sffd", Blocks{{3, 24, 24}});
  rigid::BodySet& bodies = run.bodies();
  ExchangeScene one = scene;
  one.add(17, ball, {1, 5, 5}, {0.1, 0.2, 0.3}, {0.4, 0.5, 0.6});
  rigid::BodyRecord record = one.bodies.record(0);
  record.image[1] = -7;
  const rigid::StoredImpulse impulse{99, {-1, 0, 1}, 0x123456789ABCDEFu, {1, 2, 3}};
  if (rank() == ranks() - 1) {  // owns x = 23, not x = 1, and knows nothing of the ball's place
    bodies.add(record);
    bodies.add_force(0, {1, 2, 3});
    bodies.add_torque(0, {4, 5, 6});
    bodies.stored_impulses[0] = {impulse};
    bodies.reindex();
  }
  for (const double x : {1.0, 23.5, 12.2, 1.0}) {
    const std::size_t at = bodies.row_of(17);
    if (at < bodies.owned) bodies.set_pose(at, {{x, 5, 5}, bodies.orientation[at]});
    run.exchange.relocate(bodies);
    ASSERT_EQ(sum_of(MPI_COMM_WORLD, bodies.owned), 1u);
    const int owner = run.exchange.rank_at({x, 5, 5});
    ASSERT_EQ(bodies.owned, rank() == owner ? 1u : 0u);
    ASSERT_NO_THROW(check_exchange(run.exchange, bodies, ExpectedBodies(bodies)));
    if (rank() != owner) continue;
    record.position[0] = x;
    EXPECT_EQ(hash_of(bodies.record(0)), hash_of(record));
    EXPECT_EQ(bodies.force[0].value(), Vec3(1, 2, 3));
    EXPECT_EQ(bodies.torque[0].value(), Vec3(4, 5, 6));
    ASSERT_EQ(bodies.stored_impulses[0].size(), 1u);
    const rigid::StoredImpulse& s = bodies.stored_impulses[0][0];
    EXPECT_TRUE(s.partner == impulse.partner && s.image == impulse.image && s.feature == impulse.feature &&
                s.impulse == impulse.impulse);
  }
}

TEST(BodyExchangeTies, SumsAndSharesOfRows) {
  SceneRun<> run(MPI_COMM_WORLD, planet(), "sffd", Blocks{{6, 12, 6}});
  for (int i = 0; i < 20; ++i) run.advance();
  const rigid::BodySet& bodies = run.bodies();
  std::vector<std::int64_t> sums(2 * bodies.size(), 0);
  std::vector<double> values(3 * bodies.size(), -1);
  for (std::size_t row = 0; row < bodies.first_wall(); ++row) {
    sums[2 * row] = 1;
    sums[2 * row + 1] = std::int64_t(bodies.id[row]) << rank();
    if (row < bodies.owned)
      for (int k = 0; k < 3; ++k) values[3 * row + k] = bodies.position[row][k];
  }
  run.exchange.sum_to_owners(bodies, sums, 2);
  run.exchange.share_with_copies(bodies, values, 3);
  for (std::size_t row = 0; row < bodies.first_wall(); ++row) {
    std::int64_t holders = 0, spread = 0;
    if (row < bodies.owned)
      for (const int r : run.exchange.holders(bodies, row))
        ++holders, spread += std::int64_t(bodies.id[row]) << r;
    EXPECT_EQ(sums[2 * row], holders);
    EXPECT_EQ(sums[2 * row + 1], spread);
    for (int k = 0; k < 3; ++k) EXPECT_EQ(values[3 * row + k], bodies.position[row][k]);
  }
}

/// A step has one message with each rank around: of eight slabs of 3 cells those within 4.5 cells, the
/// largest reach of a body and what it may move by in a step and a half. Nothing else goes to ranks without a
/// body.
TEST(BodyExchangeTies, OneRankSendsNothingAndOthersHearOnlyOfRanksAround) {
  SceneRun<> alone(MPI_COMM_SELF, gas(1), "sffd", Blocks{{6, 6, 6}});
  for (int i = 0; i < 50; ++i) alone.advance();
  EXPECT_EQ(alone.exchange.counters().messages, 0u);
  EXPECT_EQ(alone.bodies().copies, 0u);

  ExchangeScene pair(1, 0);  // both well inside the first block
  const int ball = pair.shape(rigid::Sphere{0.5});
  pair.add(1, ball, {0.9, 1, 1}, {0.001, 0, 0});
  pair.add(2, ball, {2.0, 1, 1}, {-0.001, 0, 0});
  SceneRun<> run(MPI_COMM_WORLD, pair, "sffd", Blocks{{3, 24, 24}});
  constexpr int steps = 50;
  const std::uint64_t at_start = run.exchange.counters().messages;
  for (int i = 0; i < steps; ++i) run.advance();
  EXPECT_EQ(run.exchange.reach(), ranks() > 1 ? 4.5 : 0);
  const int slabs = 8 / ranks(), around = std::min(2 * ((2 + slabs - 1) / slabs), ranks() - 1);
  EXPECT_EQ(run.exchange.counters().messages - at_start, std::uint64_t(steps * around));
  EXPECT_EQ(run.exchange.counters().bytes, 0u);
}

}  // namespace
}  // namespace silt::coupler
