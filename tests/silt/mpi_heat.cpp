// Heat in fluid and bodies: what is kept, what bodies and sides come to, and the same bits on any ranks, in
// any blocks and after a restart.
#include <gtest/gtest.h>
#include <mpi.h>

#include <cmath>
#include <numbers>

#include "silt/case/case.hpp"
#include "silt/simulation.hpp"
#include "tests/silt/case/case_text.hpp"
#include "tests/silt/coupled_scenes.hpp"
#include "tests/silt/same_bits.hpp"
#include "tests/world.hpp"

namespace silt::testing {
namespace {

const std::string heat = "[heat]\nthermal_diffusivity = 0.03\n";

/// The bodies of crowd(), some of a lump's temperature, some heated, some held at one, some insulating; warm
/// fluid rises, and one side gives heat.
CaseText warm_crowd(const std::string& sides = R"([{ type = "no-slip", heat_flux = 1e-3 }, "free-slip"])") {
  CaseText c = crowd();
  c.domain = domain_of({24, 20, 28}, R"({ x = "periodic", y = "periodic", z = )" + sides + " }");
  c.rest += heat + "expansion = 0.05\n";
  c.bodies = fill_of("sphere", 0.7, 4, "seed = 1\ntemperature = 1\nheat_capacity = 0.1") +
             fill_of("star", 3, 3, "seed = 2\ntemperature = -1\nheat_capacity = 2\nheat_source = 0.5") +
             fill_of("box", 4, 2, "seed = 3\ntemperature = 0.5") +
             fill_of("box", 4, 2, "seed = 4\nname = \"insulating\"");
  return c;
}

/// Returns the value of a quantity now.
double value_now(const Simulation& s, const std::string& name) {
  return Quantities(s.setup()).evaluate(s, name);
}

const std::string stored = "[[quantities]]\nname = \"stored\"\ntype = \"stored-heat\"\n";

TEST(Heat, HasOneHash) {
  expect_one_hash(warm_crowd(), 40, {"[6, 10, 7]", "[24, 20, 4]"});
}
TEST(Heat, HasOneHashInDoublePrecision) {
  CaseText c = warm_crowd();
  c.fluid += "precision = \"double\"\n";
  expect_one_hash(c, 20, {"[6, 10, 7]"});
}
TEST(Heat, GoesOnFromACheckpoint) {
  Simulation s = warm_crowd().start(MPI_COMM_WORLD);
  s.run(21);
  expect_goes_on(s, 19);
}
/// Returns what fluid and bodies lost of their heat, as a share of what the bodies had before.
double lost_heat(CaseText c, const std::string& precision, int steps) {
  c.fluid += "precision = \"" + precision + "\"\n";
  c.run += stored;
  Simulation s = c.start(MPI_COMM_WORLD);
  const double before = value_now(s, "stored");
  s.run(steps);
  return value_now(s, "stored") / before - 1;
}

/// Lumps and insulating bodies that cover and uncover cells, touch each other and the insulating sides.
TEST(Heat, OfFluidAndBodiesIsKept) {
  CaseText c = warm_crowd(R"(["no-slip", "free-slip"])");
  c.bodies = fill_of("sphere", 0.7, 4, "seed = 1\ntemperature = 1\nheat_capacity = 0.1") +
             fill_of("star", 3, 3, "seed = 2\ntemperature = 2\nheat_capacity = 2") +
             fill_of("box", 4, 4, "seed = 3");
  EXPECT_LT(std::fabs(lost_heat(c, "double", 300)), 1e-11);
  EXPECT_LT(std::fabs(lost_heat(c, "single", 300)), 1e-6);
}

TEST(Heat, WithoutExpansionMovesNothing) {
  const auto momentum_of = [](const std::string& heat_section) {
    CaseText c = crowd();
    c.rest += heat_section;
    Simulation s = c.start(MPI_COMM_WORLD);
    s.run(30);
    return s.checked_totals().momentum;
  };
  EXPECT_EQ(momentum_of(heat), momentum_of(""));
}

/// Fluid at rest between a side that gives heat and a cold one: the gradient is flux over conductivity.
TEST(Heat, FlowsStraightFromAWarmSideToAColdOne) {
  CaseText c;
  c.domain = domain_of(
      {4, 4, 16},
      R"({ x = "periodic", y = "periodic", z = [{ type = "no-slip", heat_flux = 0.02 }, { type = "no-slip", temperature = 3 }] })");
  c.fluid += "precision = \"double\"\n";
  c.rest = "[heat]\nthermal_diffusivity = 0.2\n";
  c.shapes.clear();
  c.bodies.clear();
  c.run =
      "[run]\nsteps = 20000\n[[quantities]]\nname = \"mean\"\ntype = \"mean-temperature\"\n"
      "[[quantities]]\nname = \"cold\"\ntype = \"heat-flow\"\nside = \"z-high\"\n";
  const std::vector<double> found = c.values(MPI_COMM_WORLD);
  EXPECT_NEAR(found[0], 3 + 0.02 / 0.2 * 16 / 2, 1e-8);
  EXPECT_NEAR(found[1], -0.02 * 16, 1e-9);
}

/// A hot lump, as light as a hundredth of the fluid that it displaces, in an insulating box comes to one
/// temperature with the fluid, and never swings beyond.
TEST(Heat, OfALumpGoesIntoTheFluid) {
  constexpr double diameter = 8, capacity = 0.01;
  const double volume = std::numbers::pi / 6 * std::pow(diameter, 3);
  CaseText c;
  c.domain = domain_of({16, 16, 16}, "\"no-slip\"");
  c.rest = "[heat]\nthermal_diffusivity = 0.2\n";
  c.shapes = sphere_of("ball", diameter);
  c.bodies = body_of(
      "ball", 1, "motion = \"fixed\"\nposition = [8.1, 7.9, 8.3]\ntemperature = 50\nheat_capacity = 0.01");
  c.run =
      "[run]\nsteps = 3000\n[[quantities]]\nname = \"ball\"\ntype = \"body-temperature\"\n"
      "[[quantities]]\nname = \"fluid\"\ntype = \"mean-temperature\"\n";
  const double mixed = 50 * capacity * volume / (16 * 16 * 16 - volume + capacity * volume);
  Simulation s = c.start(MPI_COMM_WORLD);
  for (int k = 0; k < 20; ++k) {
    s.step();
    const double ball = value_now(s, "ball");
    EXPECT_LT(ball, 50.0);
    EXPECT_GT(ball, 0.9 * mixed) << "after " << s.steps_done() << " steps";
  }
  s.run(2980);
  EXPECT_NEAR(value_now(s, "ball") / mixed, 1, 0.02);
  EXPECT_NEAR(value_now(s, "fluid") / value_now(s, "ball"), 1, 1e-4);
}

// ---- a mean gradient ----

/// Asks for what flows in through the low side along x, and for the mean temperature.
const std::string through_x =
    "[[quantities]]\nname = \"in\"\ntype = \"heat-flow\"\nside = \"x-low\"\n"
    "[[quantities]]\nname = \"mean\"\ntype = \"mean-temperature\"\n";

/// A cubic array of spheres, 0.3 of the volume, across the sides along the gradient.
double conductivity_of_array(const std::string& sphere) {
  constexpr int edge = 10;
  constexpr double diffusivity = 0.25, gradient = 0.2;
  CaseText c;
  c.domain = domain_of({edge, edge, edge});
  c.fluid = "[fluid]\nrelaxation_time = 1.0\n";
  c.rest = "[heat]\nthermal_diffusivity = 0.25\nmean_gradient = [0.2, 0, 0]\n";
  c.shapes = sphere_of("ball", edge * std::cbrt(6 * 0.3 / std::numbers::pi));
  c.bodies = body_of("ball", 1, "motion = \"fixed\"\nposition = [5.1, 0.2, 9.7]\n" + sphere);
  c.run = "[run]\nsteps = 400\n" + through_x;
  return c.values(MPI_COMM_WORLD)[0] / (-diffusivity * gradient * edge * edge);
}

/// Sangani, Acrivos, Proc. R. Soc. A 386 (1983) 263: scripts/accuracy/reference/conduction_arrays.csv.
TEST(MeanGradient, IsConductedThroughAnArray) {
  EXPECT_NEAR(conductivity_of_array("") / 0.60566, 1, 0.01);
  EXPECT_NEAR(conductivity_of_array("temperature = 0\n") / 2.33288, 1, 0.015);
}

/// Between insulating plates 2 h apart heat spreads in a stream of Pe = U h/D by D (1 + 2/105 Pe^2), besides
/// what the stream carries (Taylor, Aris).
TEST(MeanGradient, SpreadsInAStreamByTheLawOfTaylorAndAris) {
  constexpr int gap = 16, steps = 4000;
  constexpr double diffusivity = 0.02, gradient = 0.1, push = 1.2e-4;
  CaseText c;
  c.domain = domain_of({4, 4, gap}, R"({ x = "periodic", y = "periodic", z = ["no-slip", "no-slip"] })");
  c.fluid = "[fluid]\nrelaxation_time = 0.8\nprecision = \"double\"\nbody_force = [1.2e-4, 0, 0]\n";
  c.rest = "[heat]\nthermal_diffusivity = 0.02\nmean_gradient = [0.1, 0, 0]\n";
  c.shapes = c.bodies = "";
  c.run = "[run]\nsteps = 4000\n" + through_x;
  Simulation s = c.start(MPI_COMM_WORLD);
  s.run(steps);
  const double speed = s.checked_totals().momentum[0] / (4 * 4 * gap) + push / 2;
  const double flux = value_now(s, "in") / (4 * gap), peclet = speed * (gap / 2.) / diffusivity;
  const double spread = (speed * value_now(s, "mean") - flux) / gradient;
  EXPECT_NEAR(spread / diffusivity, 1 + 2. / 105 * peclet * peclet, 0.02 * peclet);
}

TEST(MeanGradient, HasOneHashAndGoesOn) {
  CaseText c = crowd();
  c.rest += heat + "initial = 1\nexpansion = 0.05\nmean_gradient = [0.1, -0.05, 0]\n";
  expect_one_hash(c, 30, {"[6, 10, 7]", "[24, 20, 4]"});
  Simulation s = c.start(MPI_COMM_WORLD, {"run.device=host"});
  s.run(9);
  expect_goes_on(s, 7);
}

}  // namespace
}  // namespace silt::testing
