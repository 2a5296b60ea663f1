// Balls that bounce in a fluid that is hardly viscous: potential flow keeps the speed, its added mass turns
// round with the ball.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "coupler/case/case_file.hpp"
#include "coupler/simulation.hpp"
#include "tests/world.hpp"

namespace silt::coupler {
namespace {

Case scene(const std::string& z, const std::string& bodies, const std::vector<std::string>& overrides) {
  return read_case_text(R"(
title = "rebound"
[units]
system = "lattice"
[domain]
size = [32, 32, 32]
boundary = { x = "periodic", y = "periodic", z = ")" +
                            z + R"(" }
[fluid]
relaxation_time = 0.51
[coupling]
lubrication = false
[contacts]
restitution = 1
[[shapes]]
name = "ball"
type = "sphere"
diameter = 10
)" + bodies + "[run]\nsteps = 1000\n",
                        "rebound", overrides);
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

std::string ball(const std::string& shape, int density, const std::string& position, double velocity) {
  return "[[bodies]]\nshape = \"" + shape + "\"\ndensity = " + std::to_string(density) +
         "\nposition = " + position + "\nvelocity = [0, 0, " + std::to_string(velocity) + "]\n";
}

TEST(Rebound, TurnsTheFluidRoundToo) {
  Simulation s(scene("no-slip", ball("ball", 8, "[16.31, 15.83, 9]", -0.04), {}), MPI_COMM_WORLD);
  const double ratio = rebound(s, 6);
  if (tests::rank() == 0) printf("speed kept: %.3f\n", ratio);
  EXPECT_NEAR(ratio, 1, 0.1);  // viscous loss; 0.77 where the fluid goes on to the wall
}

// Of two sizes: what is pending decays at two rates, and is in balance only with what was passed on.
TEST(Rebound, OfTwoBallsKeepsMomentum) {
  const std::string small = "[[shapes]]\nname = \"small ball\"\ntype = \"sphere\"\ndiameter = 7\n";
  const std::string balls =
      ball("ball", 2, "[16.31, 15.83, 7]", 0.03) + ball("small ball", 8, "[17.31, 15.83, 19.5]", -0.03);
  Simulation s(scene("periodic", small + balls, {"fluid.precision=double", "coupling.force=exact"}),
               MPI_COMM_WORLD);
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
}  // namespace silt::coupler
