// Streams of bodies that come and go: where and how many there are, and what they take along.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "silt/body_turnover.hpp"
#include "silt/simulation.hpp"
#include "tests/silt/case/case_text.hpp"
#include "tests/world.hpp"

namespace silt::testing {
namespace {

using rigid::Vec3;

/// A sphere comes every `every` steps at the top of a shaft and falls freely; it is taken out below. Those
/// that are there at step n came less than the fall ago: of the times k every <= n those with
/// z0 - v t - g t^2 / 2 above the outflow, as the stepper is exact in free fall.
CaseText shaft() {
  CaseText c;
  c.domain = domain_of({8, 8, 96}, R"({ x = "periodic", y = "periodic", z = ["no-slip", "no-slip"] })");
  c.fluid.clear();
  c.rest = "[gravity]\nacceleration = [0, 0, -0.002]\n[[outflow]]\nbox = [[0, 0, 0], [8, 8, 10]]\n";
  c.shapes = sphere_of("ball", 4);
  c.bodies =
      "[[fill]]\nshape = \"ball\"\ndensity = 2\narrangement = \"simple-cubic\"\ncount = 1\nevery = 30\n"
      "velocity = [0, 0, -0.2]\nspacing = 8\nbox = [[0, 0, 90], [8, 8, 96]]\n";
  return c;
}

TEST(BodyTurnover, AStreamHoldsRateTimesTransitTime) {
  Simulation s = shaft().start(MPI_COMM_WORLD);
  double z0 = 0;
  for (std::size_t row = 0; row < s.bodies().owned; ++row) z0 += s.bodies().position[row].z();
  z0 = tests::sum_over_ranks(z0);
  const auto is_there = [&](int age) { return z0 - 0.2 * age - 0.001 * age * age > 10; };
  for (int n = 1; n <= 500; ++n) {
    s.step();
    std::uint64_t expected = 0;
    for (int came = 0; came < n; came += 30) expected += is_there(n - 1 - came);
    ASSERT_EQ(s.body_count(), expected) << "step " << n;
  }
  // 0.2 T + 0.001 T^2 = z0 - 10
  const double transit = -100 + std::sqrt(1e4 + 1000 * (z0 - 10));
  EXPECT_NEAR(double(s.body_count()), transit / 30, 1);
  EXPECT_EQ(s.counters().refused, 0u);
  EXPECT_EQ(s.counters().contacts, 0u);
}

/// Quantities tell this in the report: a sphere in 30 steps leaves, and as many are there as are counted; of
/// those that were there at the start none is left, so there is no displacement.
TEST(BodyTurnover, QuantitiesTellHowManyAreThereAndLeave) {
  CaseText c = shaft();
  c.run = "[run]\nsteps = 630\n" + std::string("[[quantities]]\nname = \"rate\"\ntype = \"outflow-rate\"\n") +
          "time = 330\n[[quantities]]\nname = \"all\"\ntype = \"body-count\"\n" +
          "[[quantities]]\nname = \"below\"\ntype = \"body-count\"\nbox = [[0, 0, 0], [8, 8, 40]]\n" +
          "[[quantities]]\nname = \"moved\"\ntype = \"displacement\"\n";
  const std::vector<double> found = c.values(MPI_COMM_WORLD);
  Simulation s = c.start(MPI_COMM_WORLD);
  while (s.steps_done() < 630) s.step();
  double below = 0;
  for (std::size_t row = 0; row < s.bodies().owned; ++row) below += s.bodies().position[row].z() <= 40;
  EXPECT_EQ(found[0], 10. / 300);
  EXPECT_EQ(found[1], double(s.body_count()));
  EXPECT_EQ(found[2], tests::sum_over_ranks(below));
  EXPECT_GT(found[2], 0);
  EXPECT_TRUE(std::isnan(found[3]));
}

/// Momentum of fluid and bodies, less what those that came brought and with what those that left took, is
/// kept to rounding, although cells are covered and uncovered by both.
TEST(BodyTurnover, MomentumIsAccountedFor) {
  CaseText c;
  c.domain = domain_of({24, 24, 24});
  c.fluid += "precision = \"double\"\n";
  c.rest =
      "[coupling]\nforce = \"exact\"\n"
      "[[outflow]]\nbox = [[18, 0, 0], [24, 24, 24]]\n";
  c.shapes = sphere_of("ball", 6);
  c.bodies =
      fill_of("ball", 10, 2, "every = 40\nvelocity = [0.08, 0.02, 0]\nbox = [[0, 0, 0], [14, 24, 24]]");
  Simulation s = c.start(MPI_COMM_WORLD);
  const Balance before = s.balance();
  for (int t = 0; t < 400; ++t) s.step();
  EXPECT_GT(s.counters().left, 6u);
  const Balance now = s.balance();
  Vec3 brought;
  for (int d = 0; d < 3; ++d) brought[d] = rigid::from_fixed(s.momentum_brought().q[d]);
  EXPECT_GT(brought.norm(), 0.1 * before.momentum_scale);
  EXPECT_LT((now.momentum - before.momentum).norm(), 1e-11 * before.momentum_scale);
}

/// A body that comes with the velocity of the fluid, and one that goes, change nothing but by the flow's own
/// error: neither is struck, nor the fluid.
TEST(BodyTurnover, ABodyThatMovesWithTheFluidComesAndGoesUnnoticed) {
  for (const std::string form : {"exact", "galilean"}) {
    CaseText c;
    c.domain = domain_of({24, 24, 24});
    c.fluid =
        "[fluid]\nrelaxation_time = 0.8\nprecision = \"double\"\n"
        "initial = { type = \"uniform\", velocity = [0.02, 0, 0] }\n";
    c.rest = "[coupling]\nforce = \"" + form + "\"\n[[outflow]]\nbox = [[19, 0, 0], [24, 24, 24]]\n";
    c.shapes = sphere_of("ball", 8);
    c.bodies = fill_of("ball", 1, 1, "every = 150\nvelocity = [0.02, 0, 0]\nbox = [[6, 8, 8], [16, 16, 16]]");
    Simulation s = c.start(MPI_COMM_WORLD);
    double furthest = 0;
    for (int t = 0; t < 600; ++t) {
      s.step();
      for (std::size_t row = 0; row < s.bodies().owned; ++row)
        furthest = std::max(furthest, (s.bodies().velocity[row] - Vec3(0.02, 0, 0)).norm());
      furthest = std::max(furthest, s.checked_totals().max_speed - 0.02);
    }
    EXPECT_GT(s.counters().left, 0u);
    EXPECT_GT(s.counters().arrived, 0u);
    EXPECT_LT(tests::largest_of_ranks(furthest), 1e-4) << form;
  }
}

/// New bodies do not overlap what is there, walls, or each other; the gap is kept.
TEST(BodyTurnover, BodiesComeWhereThereIsRoom) {
  CaseText c;
  c.domain = domain_of({24, 24, 40}, "\"no-slip\"");
  c.fluid.clear();
  c.shapes = sphere_of("ball", 6);
  c.bodies = fill_of("ball", 2, 3, "gap = 0.5\nevery = 1\nbox = [[0, 0, 0], [24, 24, 40]]");
  Simulation s = c.start(MPI_COMM_SELF);
  for (int t = 0; t < 40; ++t) s.step();
  const rigid::BodySet& bodies = s.bodies();
  EXPECT_GT(s.counters().refused, 0u);
  EXPECT_GT(bodies.owned, 30u);
  for (std::size_t a = 0; a < bodies.owned; ++a) {
    for (int d = 0; d < 3; ++d) {
      EXPECT_GE(bodies.position[a][d], 3.5 - 1e-12);
      EXPECT_LE(bodies.position[a][d], s.setup().cells[d] - 3.5 + 1e-12);
    }
    for (std::size_t b = 0; b < a; ++b)
      EXPECT_GE((bodies.position[a] - bodies.position[b]).norm(), 6.5 - 1e-12) << a << ' ' << b;
  }
}

/// Neither two applications of a fill nor two fills of one seed repeat each other. Bodies leave before the
/// next ones come: room has no say in where these are.
TEST(BodyTurnover, EveryApplicationHasRandomNumbersOfItsOwn) {
  CaseText c;
  c.domain = domain_of({48, 24, 28}, "\"no-slip\"");
  c.fluid.clear();
  c.rest = "[contacts]\nsubsteps = 5\n[[outflow]]\nbox = [[0, 0, 0], [48, 24, 14]]\n";
  c.shapes = sphere_of("ball", 2);
  const std::string more = "every = 2\nvelocity = [0, 0, -7]\nbox = [[";
  c.bodies = fill_of("ball", 2, 1, more + "0, 0, 16], [24, 24, 28]]") +
             fill_of("ball", 2, 1, more + "24, 0, 16], [48, 24, 28]]");
  Simulation s = c.start(MPI_COMM_SELF);
  std::vector<Vec3> places;  // a step after they came, in the frame of the fill's box
  for (int t = 0; t < 40; ++t) {
    s.step();
    if (t % 2 != 0) continue;
    ASSERT_EQ(s.bodies().owned, 2u);
    for (std::size_t row = 0; row < 2; ++row)
      places.push_back(s.bodies().position[row] - Vec3(24. * double(row), 0, 0));
  }
  for (std::size_t a = 0; a < places.size(); ++a)
    for (std::size_t b = 0; b < a; ++b) EXPECT_GT((places[a] - places[b]).norm(), 1e-6) << a << ' ' << b;
}

}  // namespace
}  // namespace silt::testing
