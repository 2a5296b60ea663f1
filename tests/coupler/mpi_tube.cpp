// A tube as a wall of the fluid, and what fluid does to walls: exact flows, balances of momentum, and the
// same bits on any number of ranks.
#include <fmt/format.h>
#include <gtest/gtest.h>
#include <mpi.h>

#include <cmath>
#include <numbers>

#include "coupler/simulation.hpp"
#include "tests/coupler/case/pipe_case.hpp"
#include "tests/world.hpp"

namespace silt::coupler::testing {
namespace {

using std::numbers::pi;

/// Blocks of nothing but wall do not collide: the same bits as with one block.
TEST(Tube, SameBitsForAnyBlocksAndRanks) {
  CaseText c = pipe(6.2, "angular_velocity = 0.002", 1e-5, 1);
  c.domain =
      "[domain]\nsize = [16, 32, 32]\nboundary = { x = \"periodic\", y = [\"no-slip\", \"no-slip\"], z = "
      "[\"no-slip\", \"no-slip\"] }\n";
  c.rest =
      "[gravity]\nacceleration = [0, 0, -1e-4]\n"
      "[[walls]]\ntype = \"tube\"\nradius = 11\naxis = [1, 0, 0]\npoint = [3, 16.2, 16.4]\nangular_velocity "
      "= 1e-3\n";
  c.shapes = CaseText().shapes;
  c.bodies = "[[bodies]]\nshape = \"ball\"\ndensity = 2\npositions = [[4, 16, 9.5], [13, 14, 20]]\n";
  const auto hash = [&](const std::string& blocks, MPI_Comm comm) {
    Simulation simulation = c.start(comm, {"domain.blocks=" + blocks});
    simulation.run(150);
    return simulation.hash();
  };
  const std::uint64_t alone = tests::alone([&] { return hash("[16, 32, 32]", MPI_COMM_SELF); });
  EXPECT_EQ(hash("[8, 8, 8]", MPI_COMM_WORLD), alone);
  EXPECT_EQ(hash("[16, 4, 4]", MPI_COMM_WORLD), alone);
}

/// A ball dropped into a tube full of fluid ends at its lowest line.
TEST(Tube, BallSettlesOnTheLowestLine) {
  CaseText c = pipe(11, "", 0, 1);
  c.fluid = "[fluid]\nrelaxation_time = 1\n";
  c.domain.replace(c.domain.find("size = [4"), 9, "size = [16");
  c.rest += "[gravity]\nacceleration = [0, 0, -2e-3]\n";
  c.shapes = CaseText().shapes;
  c.bodies = "[[bodies]]\nshape = \"ball\"\ndensity = 3\nposition = [8, 14, 10]\n";
  Simulation simulation = c.start(MPI_COMM_WORLD, {"domain.blocks=[8, 12, 12]"});
  simulation.run(2500);
  const auto& bodies = simulation.bodies();
  for (std::size_t row = 0; row < bodies.owned; ++row) {
    EXPECT_NEAR(bodies.position[row][1], 12.13, 0.3);
    EXPECT_NEAR(bodies.position[row][2], 11.71 - 7, 0.05);
  }
  EXPECT_LT(simulation.counters().penetration, 0.02);
}

/// As a pressure gradient, the body force takes a free ball of the fluid's density along with the fluid.
TEST(BodyForce, OnBodiesMovesBallAndFluidAlike) {
  CaseText c;
  c.domain = "[domain]\nsize = [24, 24, 24]\nblocks = [12, 12, 12]\nboundary = \"periodic\"\n";
  c.fluid = "[fluid]\nrelaxation_time = 0.8\nbody_force = [1e-5, 0, 0]\nbody_force_on_bodies = true\n";
  c.bodies = "[[bodies]]\nshape = \"ball\"\ndensity = 1\nposition = [12.2, 11.9, 12]\n";
  Simulation simulation = c.start(MPI_COMM_WORLD);
  simulation.run(500);
  const auto& bodies = simulation.bodies();
  for (std::size_t row = 0; row < bodies.owned; ++row)
    EXPECT_NEAR(bodies.velocity[row][0], 500 * 1e-5, 2e-2 * 500 * 1e-5);
}

double quantity_of(const CaseText& text) {
  return text.values(MPI_COMM_WORLD).front();
}

CaseText couette(const std::string& quantity) {
  CaseText c;
  c.domain =
      "[domain]\nsize = [8, 8, 16]\nblocks = [4, 4, 8]\nboundary = { x = \"periodic\", y = \"periodic\", z = "
      "[\"no-slip\", { type = \"moving\", velocity = [0.03, 0.04, 0] }] }\n";
  c.fluid = "[fluid]\nrelaxation_time = 0.8\nprecision = \"double\"\n";
  c.shapes = c.bodies = "";
  c.run = "[run]\nsteps = 6000\n[[quantities]]\nname = \"q\"\n" + quantity + "\ntime = 5999\n";
  return c;
}

/// mu U / H on the side that rests, and against the motion on the one that moves.
TEST(WallQuantities, StressOfPlaneCouetteFlow) {
  const double stress = 0.1 / 16;
  const std::string type = "type = \"wall-stress\"\n";
  EXPECT_NEAR(quantity_of(couette(type + "side = \"z-low\"\naxis = \"x\"")), 0.03 * stress, 1e-9 * stress);
  EXPECT_NEAR(quantity_of(couette(type + "side = \"z-high\"\naxis = \"y\"")), -0.04 * stress, 1e-9 * stress);
  EXPECT_NEAR(quantity_of(couette(type + "side = \"z-high\"\naxis = \"z\"")), 0, 1e-3 * stress);
  EXPECT_NEAR(quantity_of(couette("type = \"relative-viscosity\"\naxis = \"z\"")), 1, 1e-7);
}

/// A ball of twice the fluid's density on the floor presses with its weight less its buoyancy.
TEST(WallQuantities, StressOfABallOnTheFloor) {
  CaseText c = couette("type = \"wall-stress\"\nside = \"z-low\"\naxis = \"z\"");
  c.domain =
      "[domain]\nsize = [16, 16, 16]\nblocks = [8, 8, 8]\nboundary = { x = \"periodic\", y = \"periodic\", "
      "z "
      "= [\"no-slip\", \"no-slip\"] }\n";
  c.fluid = "[fluid]\nrelaxation_time = 1\n";
  c.rest = "[gravity]\nacceleration = [0, 0, -1e-3]\n";
  c.shapes = CaseText().shapes;
  c.bodies = "[[bodies]]\nshape = \"ball\"\ndensity = 2\nposition = [8, 8, 4.1]\n";
  const double weight = 4. / 3 * pi * 64 * 1e-3;
  c.run =
      "[run]\nsteps = 1500\n[[quantities]]\nname = \"q\"\ntype = \"wall-stress\"\nside = \"z-low\"\naxis = "
      "\"z\"\ntime = 1400\n";
  EXPECT_NEAR(quantity_of(c), -weight / 256, 2e-2 * weight / 256);
}

TEST(WallQuantities, DistanceFromTheAxis) {
  CaseText c = pipe(11, "", 0, 1);
  c.fluid = "";
  c.shapes = CaseText().shapes;
  c.bodies = "[[bodies]]\nshape = \"ball\"\ndensity = 3\nposition = [2, 15.13, 15.71]\n";
  c.domain.replace(c.domain.find("size = [4"), 9, "size = [16");
  c.run = "[run]\nsteps = 1\n[[quantities]]\nname = \"q\"\ntype = \"axis-distance\"\n";
  EXPECT_NEAR(quantity_of(c), 5, 1e-12);
}

}  // namespace
}  // namespace silt::coupler::testing
