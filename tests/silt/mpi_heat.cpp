// Heat in fluid and bodies: none is lost, and the bits are the same on any ranks, in any blocks and after a
// restart.
#include <gtest/gtest.h>
#include <mpi.h>

#include <cmath>

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
/// fluid rises, one side gives heat, and one has a temperature.
CaseText warm_crowd(
    const std::string& sides =
        R"([{ type = "no-slip", heat_flux = 1e-3 }, { type = "no-slip", temperature = 1 }])") {
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
/// Insulating balls, face-centred between a warm and a cold plane: pockets have links of several blocks.
TEST(Heat, InPocketsBetweenInsulatingBallsHasOneHash) {
  CaseText c;
  c.domain = domain_of(
      {15, 15, 15},
      R"({ x = "periodic", y = "periodic", z = [{ type = "no-slip", temperature = 1 }, "no-slip"] })");
  c.shapes = sphere_of("ball", 7.8);
  c.bodies =
      body_of("ball", 1,
              "motion = \"fixed\"\npositions = [[7.5, 8, 4.1], [0.2, 0.5, 4.1], [7.5, 0.4, 10.9], [0.1, 8.1, "
              "10.9]]\n");
  c.rest = "[heat]\nthermal_diffusivity = 0.2\n";
  expect_one_hash(c, 40, {"\"auto\"", "[5, 15, 5]", "[8, 4, 15]"});
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
  c.bodies = fill_of("sphere", 0.7, 4, "seed = 1\ntemperature = 1\nheat_capacity = 0.002") +
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
