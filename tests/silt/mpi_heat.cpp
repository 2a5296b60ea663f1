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

}  // namespace
}  // namespace silt::testing
