// Heat of bodies that fly through cells of several levels, which follow them: none is lost, and the bits are
// the same on any number of ranks, on a device and after a restart.
#include <gtest/gtest.h>

#include <cmath>

#include "silt/case/case.hpp"
#include "silt/results/quantities.hpp"
#include "silt/simulation.hpp"
#include "tests/silt/case/case_text.hpp"
#include "tests/silt/same_bits.hpp"
#include "tests/world.hpp"

namespace silt::coupler::testing {
namespace {

using silt::testing::body_of;
using silt::testing::CaseText;
using silt::testing::domain_of;
using silt::testing::sphere_of;

constexpr const char* levels = "[coarsening]\nlevels = 2\ndistance = 7\n";

CaseText flying(const std::string& precision, const std::string& coarsening) {
  CaseText c;
  c.domain = domain_of({96, 64, 64});
  c.fluid += "precision = \"" + precision + "\"\n";
  c.rest =
      "[heat]\nthermal_diffusivity = 0.05\ninitial = 0.5\nexpansion = 0.1\n[gravity]\nacceleration = "
      "[0, 0, -1e-4]\n[[quantities]]\nname = \"heat\"\ntype = \"stored-heat\"\n" +
      coarsening;
  c.shapes = sphere_of("sphere", 6.5);
  c.bodies = body_of("sphere", 200,
                     "name = \"warm\"\ntemperature = 3\nheat_capacity = 0.01\nposition = [5.2, 16.1, 7.3]\n"
                     "velocity = [0.08, 0.03, 0.0]") +
             body_of("sphere", 100,
                     "name = \"insulating\"\nposition = [67.4, 26.9, 17.9]\nvelocity = [-0.06, 0.0, 0.05]");
  c.run = "[run]\nsteps = 640\n";
  return c;
}

/// The warm body is fixed in a mean gradient.
CaseText flying_in_a_gradient() {
  CaseText c = flying("single", levels);
  c.rest.replace(c.rest.find("initial"), 0, "mean_gradient = [0.01, 0, 0.02]\n");
  c.bodies.replace(c.bodies.find("velocity = [0.08, 0.03, 0.0]"), 28, "motion = \"fixed\"");
  return c;
}

TEST(WarmLevels, AreTheSameOnAnyRanksAndDevice) {
  for (const CaseText& text : {flying("single", ""), flying("single", levels), flying_in_a_gradient()}) {
    const auto hash = [&](MPI_Comm comm, const std::string& device) {
      Simulation s = text.start(comm, {"run.device=" + device});
      while (s.steps_done() < 112) s.step();
      return s.hash();
    };
    const std::uint64_t alone = tests::alone([&] { return hash(MPI_COMM_SELF, "cpu"); });
    EXPECT_EQ(alone, hash(MPI_COMM_WORLD, "cpu")) << text.rest;
    EXPECT_EQ(alone, hash(MPI_COMM_WORLD, "host")) << text.rest;
  }
}

TEST(WarmLevels, GoOnFromACheckpoint) {
  Simulation s = flying("single", levels).start(MPI_COMM_WORLD);
  s.run(68);
  silt::testing::expect_goes_on(s, 60);
}

TEST(WarmLevels, LoseNoHeat) {
  Simulation s = flying("double", levels).start(MPI_COMM_WORLD);
  const auto heat = [&] { return Quantities(s.setup()).evaluate(s, "heat"); };
  const double before = heat();
  const lbm::CutTree cut = s.scene().level_view().tree();
  while (s.steps_done() < 112) s.step();
  EXPECT_FALSE(s.scene().level_view().tree() == cut);
  EXPECT_NEAR(heat() / before, 1, 1e-9);
}

}  // namespace
}  // namespace silt::coupler::testing
