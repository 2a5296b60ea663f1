// Balls that bounce in a fluid that is hardly viscous: potential flow keeps the speed, its added mass turns
// round with the ball.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "coupler/simulation.hpp"
#include "tests/coupler/case/case_text.hpp"
#include "tests/world.hpp"

namespace silt::coupler::testing {
namespace {

/// Balls of a perfect rebound in a box of 32 cells.
CaseText scene(const std::string& z, const std::string& bodies) {
  CaseText c;
  c.domain = domain_of({32, 32, 32}, "{ x = \"periodic\", y = \"periodic\", z = \"" + z + "\" }");
  c.fluid = "[fluid]\nrelaxation_time = 0.51\n";
  c.rest = "[coupling]\nlubrication = false\n[contacts]\nrestitution = 1\n";
  c.shapes = sphere_of("ball", 10) + sphere_of("small ball", 7);
  c.bodies = bodies;
  return c;
}

/// Height of the lowest ball and its velocity.
struct State {
  double z, v;
};
State lowest(const Simulation& s) {
  double mine[2] = {0, 0};
  if (const std::size_t row = s.bodies().row_of(1); row < s.bodies().owned)
    mine[0] = s.bodies().position[row][2], mine[1] = s.bodies().velocity[row][2];
  return {tests::sum_over_ranks(mine[0]), tests::sum_over_ranks(mine[1])};
}

/// Its speed once it has come back to the height over what it was there on the way down (0: it does not).
double rebound(Simulation& s, double height) {
  double fall = 0;
  while (s.steps_done() < 400) {
    s.step();
    const State now = lowest(s);
    if (now.v < 0 && now.z > height) fall = -now.v;
    if (now.v > 0 && now.z > height) return now.v / fall;
  }
  return 0;
}

std::string ball(const std::string& shape, double density, const std::string& position, double velocity) {
  return body_of(shape, density, fmt::format("position = {}\nvelocity = [0, 0, {}]", position, velocity));
}

TEST(Rebound, TurnsTheFluidRoundToo) {
  Simulation s = scene("no-slip", ball("ball", 8, "[16.31, 15.83, 9]", -0.04)).start(MPI_COMM_WORLD);
  const double ratio = rebound(s, 6);
  if (tests::rank() == 0) printf("speed kept: %.3f\n", ratio);
  EXPECT_NEAR(ratio, 1, 0.1);  // viscous loss; 0.77 where the fluid goes on to the wall
}

/// A heavy ball meets the floor under a film that stops it within a sub-step: the fluid next to it must not
/// feel more than the ball did. Where in a step they meet is a matter of chance, so several starts.
TEST(Rebound, UnderAFilmThrowsNoFluid) {
  for (const double start : {6.0, 6.003, 6.006, 6.009, 6.012, 6.015, 6.018, 6.021, 6.024, 6.027}) {
    CaseText c = scene("no-slip", ball("ball", 8, fmt::format("[16.31, 15.83, {}]", start), -0.03));
    c.fluid = "[fluid]\nrelaxation_time = 0.53\n";
    c.rest = "[coupling]\nlubrication_min_gap = 5e-4\n[contacts]\nrestitution = 0.97\nsubsteps = 10\n";
    Simulation s = c.start(MPI_COMM_WORLD);
    double fastest = 0;
    while (s.steps_done() < 50) {
      s.step();
      fastest = std::max(fastest, s.look_at_flow().max_speed);
    }
    EXPECT_GT(lowest(s).v, 0) << start;  // it has come back
    EXPECT_LT(fastest, 2 * 0.03) << start;
  }
}

// Of two sizes: what is pending decays at two rates, and is in balance only with what was passed on.
TEST(Rebound, OfTwoBallsKeepsMomentum) {
  const std::string balls =
      ball("ball", 2, "[16.31, 15.83, 7]", 0.03) + ball("small ball", 8, "[17.31, 15.83, 19.5]", -0.03);
  Simulation s =
      scene("periodic", balls).start(MPI_COMM_WORLD, {"fluid.precision=double", "coupling.force=exact"});
  const Balance before = s.balance();
  double drift = 0;
  while (s.steps_done() < 150) {
    s.step();
    if (s.steps_done() % 5 == 0) drift = std::max(drift, (s.balance().momentum - before.momentum).norm());
  }
  EXPECT_LT(lowest(s).v, 0);  // they have met
  EXPECT_LT(drift, 1e-11 * before.momentum_scale);
}

}  // namespace
}  // namespace silt::coupler::testing
