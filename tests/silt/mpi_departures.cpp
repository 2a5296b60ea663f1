// No body lives on outside the domain: it is taken out, counted and logged, or the run stops; the same on any
// number of ranks.
#include "silt/body_turnover.hpp"

#include <gtest/gtest.h>

#include <bit>
#include <numeric>

#include "silt/case/case.hpp"
#include "silt/guard.hpp"
#include "silt/simulation.hpp"
#include "tests/errors.hpp"
#include "tests/silt/case/case_text.hpp"
#include "tests/world.hpp"

namespace silt::testing {
namespace {

using rigid::Vec3;
using tests::alone;

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
