// Bodies that come and go: none is lost, doubled or named twice, none lives on outside the domain, and all of
// it is the same to the bit on any number of ranks, whatever the cut and across a checkpoint.
#include "silt/body_turnover.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <numeric>

#include "rigid/response/warm_start.hpp"
#include "silt/case/case.hpp"
#include "silt/guard.hpp"
#include "silt/simulation.hpp"
#include "tests/errors.hpp"
#include "tests/odd_cut.hpp"
#include "tests/silt/case/case_text.hpp"
#include "tests/silt/same_bits.hpp"
#include "tests/world.hpp"

namespace silt::testing {
namespace {

using rigid::BodyId;
using rigid::Vec3;
using tests::alone;
using tests::ranks;

/// Spheres and capsules that come in at the top, settle on each other through the ranks, and are taken out at
/// the bottom and beyond an open side. There is no room for all that want to come.
CaseText stream(const std::string& fluid) {
  CaseText c;
  c.domain = domain_of({24, 24, 48},
                       "{ x = \"periodic\", y = [\"no-slip\", { type = \"no-slip\", solid_for_bodies = "
                       "false }], z = [\"no-slip\", \"no-slip\"] }");
  c.fluid = fluid;
  c.rest = R"([gravity]
acceleration = [1e-3, 2e-3, -8e-3]
[contacts]
restitution = 0.3
friction = 0.3
[[outflow]]
box = [[0, 0, 0], [24, 14, 12]]
)";
  c.shapes = sphere_of("ball", 5) + shape_of("rod", "capsule", "radius = 1.8\nlength = 2");
  c.bodies = fill_of("ball", 2, 9, "every = 8\nvelocity = [0, 0, -0.05]\nbox = [[0, 0, 30], [24, 24, 48]]") +
             fill_of("rod", 3, 2, "every = 20\nseed = 4\nbox = [[0, 0, 26], [24, 24, 48]]") +
             "[[fill]]\nshape = \"rod\"\ndensity = 2\narrangement = \"hexagonal\"\nshift = 0.2\nevery = 30\n"
             "box = [[0, 0, 14], [12, 24, 26]]\n";
  return c;
}

const std::string with_fluid = "[fluid]\nrelaxation_time = 0.8\n";

struct Flux {
  std::uint64_t arrived, left, refused, there;
  bool operator==(const Flux&) const = default;
};

Flux flux(const Simulation& s) {
  const RunCounters c = s.counters();
  return {c.arrived, c.left, c.refused, s.body_count()};
}

/// The hash after so many steps, and with it what came and went.
std::uint64_t hash_after(Simulation&& s, int steps, int cut_every = 0) {
  for (int t = 0; t < steps; ++t) {
    if (cut_every > 0 && t % cut_every == 2)
      s.repartition(tests::odd_cut(s.scene().domain.cells(), ranks(), 3, unsigned(t)));
    s.step();
  }
  const Flux f = flux(s);
  EXPECT_GT(f.left, 3u);
  EXPECT_GT(f.refused, 0u);
  return s.hash() + 1000003 * f.arrived + 10007 * f.refused + 101 * f.left + s.next_id();
}

void expect_one_hash(const std::string& fluid, const Overrides& overrides, int steps) {
  const CaseText text = stream(fluid);
  const std::uint64_t one = alone([&] { return hash_after(text.start(MPI_COMM_SELF, overrides), steps); });
  EXPECT_EQ(hash_after(text.start(MPI_COMM_WORLD, overrides), steps), one);
  Overrides balanced = overrides;
  balanced.push_back("run.balance.every=10");
  EXPECT_EQ(hash_after(text.start(MPI_COMM_WORLD, balanced), steps, 7), one)
      << "across cuts and looks at the balance";
}

TEST(BodyTurnover, DryBodiesComeAndGoAlikeOnAnyRanks) {
  expect_one_hash("", {}, 250);
}

TEST(BodyTurnover, BodiesInAFluidComeAndGoAlikeOnAnyRanks) {
  expect_one_hash(with_fluid, {}, 280);
}

TEST(BodyTurnover, TheyDoInTheExactForm) {
  expect_one_hash(with_fluid, {"coupling.force=exact", "fluid.precision=double"}, 280);
}

// ---- who is there ----

/// The ids that all ranks own, sorted.
std::vector<BodyId> ids_of(const Simulation& s) {
  int mine = int(s.bodies().owned), n = ranks();
  std::vector<int> counts(n), first(n + 1, 0);
  MPI_Allgather(&mine, 1, MPI_INT, counts.data(), 1, MPI_INT, MPI_COMM_WORLD);
  for (int r = 0; r < n; ++r) first[r + 1] = first[r] + counts[r];
  std::vector<BodyId> ids(first[n]);
  MPI_Allgatherv(s.bodies().id.data(), mine, MPI_UINT64_T, ids.data(), counts.data(), first.data(),
                 MPI_UINT64_T, MPI_COMM_WORLD);
  std::sort(ids.begin(), ids.end());
  return ids;
}

/// Ids that have left never come back, new ones count on from those before, and the numbers add up.
TEST(BodyTurnover, NoIdIsUsedTwice) {
  Simulation s = stream("").start(MPI_COMM_WORLD);
  std::vector<BodyId> before = ids_of(s);
  const std::uint64_t at_start = before.size();
  BodyId next = before.back() + 1;
  for (int t = 0; t < 250; ++t) {
    s.step();
    const std::vector<BodyId> now = ids_of(s);
    ASSERT_EQ(std::adjacent_find(now.begin(), now.end()), now.end()) << "step " << t;
    std::vector<BodyId> fresh;
    std::set_difference(now.begin(), now.end(), before.begin(), before.end(), std::back_inserter(fresh));
    for (const BodyId id : fresh) ASSERT_EQ(id, next++) << "step " << t;
    ASSERT_EQ(s.next_id(), next);
    before = now;
    const Flux f = flux(s);
    ASSERT_EQ(f.there, at_start + f.arrived - f.left);
    ASSERT_EQ(f.there, now.size());
  }
  EXPECT_GT(flux(s).left, 10u);
}

// ---- at a corner of ranks ----

/// Two light balls with a film between them; the lower one, on the corner that eight ranks share, is about to
/// leave by its place.
CaseText at_the_corner() {
  CaseText c;
  c.domain = domain_of({32, 32, 32}, R"({ x = "periodic", y = "periodic", z = ["no-slip", "no-slip"] })");
  c.rest = "[[outflow]]\nbox = [[15, 15, 15.02], [17, 17, 17]]\n";
  c.shapes = sphere_of("ball", 8);
  c.bodies = body_of("ball", 0.3, "position = [16, 16, 15]\nvelocity = [0, 0, 0.03]") +
             body_of("ball", 0.3, "position = [16, 16, 23.1]\nvelocity = [0, 0, -0.03]");
  return c;
}

/// Over the ranks of a communicator.
std::uint64_t sum(MPI_Comm comm, std::uint64_t n) {
  MPI_Allreduce(MPI_IN_PLACE, &n, 1, MPI_UINT64_T, MPI_SUM, comm);
  return n;
}

struct Leaving {
  int step;  // done when the body leaves
  std::uint64_t hash;
};

/// Runs past the leaving of body 1; where told so, what is remembered of its film is taken away before.
Leaving leave_at_the_corner(MPI_Comm comm, const Overrides& overrides, int forget_at) {
  Simulation s = at_the_corner().start(comm, overrides);
  const std::uint64_t all = sum(comm, 1);
  const auto holders = [&] { return sum(comm, s.bodies().row_of(1) < s.bodies().size()); };
  const auto films = [&] {
    const std::size_t row = s.bodies().row_of(2);
    return sum(comm, row < s.bodies().owned ? s.bodies().stored_impulses[row].size() : 0);
  };
  std::uint64_t held = 0, remembered = 0;
  while (s.body_count() == 2 && s.steps_done() < 60) {
    held = holders(), remembered = films();
    if (s.steps_done() == forget_at) rigid::forget_impulses(s.bodies(), 1);
    s.step();
  }
  const int left_at = int(s.steps_done()) - 1;
  EXPECT_GT(left_at, 0);
  EXPECT_GT(remembered, 0u);
  EXPECT_EQ(held, all);
  EXPECT_EQ(s.counters().left, 1u);
  EXPECT_EQ(holders(), 0u);
  for (int t = 0; t < 10; ++t) s.step();
  EXPECT_EQ(s.body_count(), 1u);
  return {left_at, s.hash()};
}

/// It is gone from all ranks that held it, and with it the film: the other one goes on as if there was none.
TEST(BodyTurnover, ABodyAtACornerOfRanksLeavesAllThatHeldIt) {
  const std::uint64_t one = alone([] { return leave_at_the_corner(MPI_COMM_SELF, {}, -1).hash; });
  const Overrides blocks{"domain.blocks=[16, 16, 16]"};
  const Leaving found = leave_at_the_corner(MPI_COMM_WORLD, blocks, -1);
  EXPECT_EQ(found.hash, one);
  EXPECT_EQ(leave_at_the_corner(MPI_COMM_WORLD, blocks, found.step).hash, one) << "film forgotten before";
}

// ---- across a checkpoint ----

TEST(BodyTurnover, ARunGoesOnToTheBit) {
  constexpr int steps = 200;
  for (const std::string& fluid : {std::string(), with_fluid}) {
    const CaseText text = stream(fluid);
    for (const int at : {120, 121}) {  // 120: before bodies of all fills come
      Simulation s = text.start(MPI_COMM_WORLD);
      s.run(at);
      const Saved saved(s);
      const auto resumed = saved.go_on(s.setup());
      const Flux before = flux(s);
      s.run(steps - at);
      resumed->run(steps - at);
      EXPECT_EQ(flux(*resumed), flux(s));
      EXPECT_EQ(resumed->next_id(), s.next_id());
      EXPECT_GT(flux(s).left, before.left);
      EXPECT_GT(flux(s).arrived, before.arrived);
      EXPECT_EQ(resumed->hash(), s.hash());
    }
  }
}

/// A side that bodies leave by.
std::string open_side(const std::string& type = "no-slip") {
  return "{ type = \"" + type + "\", solid_for_bodies = false }";
}

/// Two balls of radius 2 on their way to the upper side of z at a quarter of a cell a step, from 20 of 24:
/// one free, one of prescribed motion. Wholly beyond when 20 + n / 4 - 2 > 24, so after 25 steps. A fixed one
/// stays in an outflow.
CaseText on_the_way_out(const std::string& upper_side) {
  CaseText c;
  c.domain = domain_of({24, 24, 24},
                       "{ x = \"periodic\", y = \"periodic\", z = [\"no-slip\", " + upper_side + "] }");
  c.fluid.clear();
  c.shapes = sphere_of("ball", 4);
  c.bodies = body_of("ball", 2, "position = [6, 6, 20]\nvelocity = [0, 0, 0.25]") +
             body_of("ball", 2, "position = [18, 6, 20]\nvelocity = [0, 0, 0.25]\nmotion = \"prescribed\"") +
             body_of("ball", 2, "position = [6, 18, 2]\nmotion = \"fixed\"");
  c.rest = "[[outflow]]\nbox = [[0, 0, 0], [24, 24, 4]]\n";
  return c;
}

TEST(Departures, AreToldWithStepIdAndSide) {
  Simulation s = on_the_way_out(open_side()).start(MPI_COMM_WORLD);
  s.run(25);
  EXPECT_EQ(s.body_count(), 3u);
  s.run(5);
  EXPECT_EQ(s.body_count(), 1u) << "the fixed one";
  EXPECT_EQ(s.counters().left, 2u);
  EXPECT_EQ(s.counters().left_by[5], 2u);
  const std::vector<Departure> left = gathered(MPI_COMM_WORLD, s.take_departures());
  if (s.scene().rank() != 0) return;
  ASSERT_EQ(left.size(), 2u);
  for (int k = 0; k < 2; ++k) {
    EXPECT_EQ(left[k].step, 25);
    EXPECT_EQ(left[k].id, rigid::BodyId(k + 1));
    EXPECT_EQ(way_text(int(left[k].way)), "z-high");
    EXPECT_DOUBLE_EQ(left[k].position[2], 26.25);
  }
}

/// Runs until a guard stops it; returns its text.
std::string stop_of(const CaseText& c, int steps, std::int64_t& at) {
  Simulation s = c.start(MPI_COMM_WORLD);
  const std::string text = tests::error_of<CommonGuardStop>([&] {
    for (int t = 0; t < steps; ++t) s.step();
    s.settle();
  });
  at = s.steps_done();
  return text;
}

TEST(Departures, ABodyThatIsMovedThroughAWallStopsARun) {
  CaseText c = on_the_way_out("\"no-slip\"");
  c.bodies = body_of("ball", 2, "position = [18, 6, 20]\nvelocity = [0, 0, 0.25]\nmotion = \"prescribed\"");
  std::int64_t at = 0;
  const std::string text = stop_of(c, 100, at);
  EXPECT_TEXT(text, "step 64: body 1 has left the domain past z-high, a wall");
  EXPECT_TEXT(stop_of(c, 40, at), "step 40: body 1") << "at the end of a shorter run";
}

/// Balls that fly apart in a box whose sides are all open, and one outflow.
CaseText burst(const std::string& fluid, const std::string& side) {
  CaseText c;
  c.domain = domain_of({24, 24, 24}, "{ x = [" + side + ", " + side + "], y = [" + side + ", " + side +
                                         "], z = [" + side + ", " + side + "] }");
  c.fluid = fluid;
  c.rest = "[gravity]\nacceleration = [2e-4, 1e-4, -4e-4]\n[[outflow]]\nbox = [[0, 0, 0], [8, 8, 8]]\n";
  c.shapes = sphere_of("ball", 5) + shape_of("rod", "capsule", "radius = 1.8\nlength = 2");
  c.bodies.clear();
  const double u = 0.05;
  for (const auto& [x, v] : {std::pair(Vec3(18, 12, 12), Vec3(u, 0, 0)),
                             {Vec3(6, 12, 12), Vec3(-u, 0, 0)},
                             {Vec3(12, 18, 12), Vec3(0, u, 0)},
                             {Vec3(12, 6, 12), Vec3(0, -u, 0)},
                             {Vec3(12, 12, 18), Vec3(0, 0, u)},
                             {Vec3(12, 12, 6), Vec3(0, 0, -u)}}) {
    const auto list = [](const Vec3& w) {
      return "[" + std::to_string(w[0]) + ", " + std::to_string(w[1]) + ", " + std::to_string(w[2]) + "]";
    };
    c.bodies += body_of(v[0] != 0 ? "rod" : "ball", 3, "position = " + list(x) + "\nvelocity = " + list(v));
  }
  return c;
}

std::uint64_t burst_hash(const CaseText& text, MPI_Comm comm) {
  Simulation s = text.start(comm);
  std::vector<Departure> left;
  while (s.body_count() > 0 && s.steps_done() < 2000) {
    s.step();
    const rigid::BodySet& bodies = s.bodies();
    for (std::size_t row = 0; row < bodies.owned; ++row)  // at the most a step beyond
      EXPECT_FALSE(
          side_behind(s.setup(), bodies.position[row],
                      s.scene().world.bounding_radii[bodies.shape[row]] + bodies.velocity[row].norm()));
    const auto now = gathered(comm, s.take_departures());
    left.insert(left.end(), now.begin(), now.end());
  }
  EXPECT_EQ(s.body_count(), 0u) << "all are gone in the end";
  const RunCounters counters = s.counters();
  EXPECT_EQ(std::accumulate(std::begin(counters.left_by), std::end(counters.left_by), std::uint64_t(0)), 6u);
  EXPECT_EQ(counters.left, 6u);
  std::uint64_t hash = s.hash();
  for (const Departure& d : left) {
    hash = hash * 1000003 + std::uint64_t(d.step) * 101 + d.id * 11 + std::uint64_t(d.way);
    for (const double x : d.position) hash = hash * 31 + std::bit_cast<std::uint64_t>(x);
  }
  EXPECT_EQ(left.size(), s.scene().rank() == 0 ? 6u : 0u);
  MPI_Bcast(&hash, 1, MPI_UINT64_T, 0, comm);
  return hash;
}

TEST(Departures, DryNoBodyLivesOnOutside) {
  const CaseText c = burst("", open_side());
  const std::uint64_t one = alone([&] { return burst_hash(c, MPI_COMM_SELF); });
  EXPECT_EQ(burst_hash(c, MPI_COMM_WORLD), one);
}

TEST(Departures, NorDoesOneThroughOutletsOfAFluid) {
  const CaseText c = burst("[fluid]\nrelaxation_time = 0.8\n", open_side("pressure-outlet"));
  const std::uint64_t one = alone([&] { return burst_hash(c, MPI_COMM_SELF); });
  EXPECT_EQ(burst_hash(c, MPI_COMM_WORLD), one);
}

}  // namespace
}  // namespace silt::testing
