// The flows that a run may begin with, and driven ones: with the same bits on any ranks and in runs that go
// on.
#include <gtest/gtest.h>
#include <mpi.h>

#include <cmath>

#include "coupler/flow_control.hpp"
#include "rigid/bodies/prescribed_motion.hpp"
#include "silt/case/case.hpp"
#include "silt/simulation.hpp"
#include "tests/silt/case/case_text.hpp"
#include "tests/silt/coupled_scenes.hpp"
#include "tests/silt/same_bits.hpp"
#include "tests/world.hpp"

namespace silt::coupler::testing {
namespace {

/// Each component of each cell is uniform between -a and a: the mean of u.u/2
/// is a^2/2, to three deviations of a mean over 32768 cells.
TEST(InitialFlow, NoiseIsBoundedAndTheSameOnAnyRanks) {
  const double noise = 0.01;
  CaseText c;
  c.fluid =
      "[fluid]\nprecision = \"double\"\nrelaxation_time = 0.8\ninitial = { type = \"rest\", noise = 0.01 }\n";
  c.shapes = c.bodies = "";
  c.run = "[run]\nsteps = 1\n[[quantities]]\nname = \"e\"\ntype = \"kinetic-energy\"\ntime = 0\n";
  const Overrides odd_blocks{"domain.blocks=[8, 16, 8]"};
  Simulation simulation = c.start(MPI_COMM_WORLD, odd_blocks);
  const FlowTotals start = simulation.checked_totals();
  EXPECT_LE(start.max_speed, std::sqrt(3.) * noise * (1 + 1e-12));
  EXPECT_GT(start.max_speed, 1.6 * noise) << "32768 points of a cube come near its corners";
  const std::uint64_t everywhere = simulation.hash();
  const std::uint64_t alone = tests::alone([&] { return c.start(MPI_COMM_SELF).hash(); });
  EXPECT_EQ(everywhere, alone);
  EXPECT_NEAR(c.values(MPI_COMM_WORLD)[0] / (noise * noise / 2), 1, 3 * std::sqrt(4. / 15 / 32768));
}

/// Everything at once, among bodies.
CaseText driven_crowd() {
  CaseText c = crowd();
  c.domain = domain_of(
      {24, 20, 28},
      "{ x = \"periodic\", y = \"periodic\", z = [{ type = \"moving\", velocity = [0.03, 0.01, 0], over_time "
      "= { table = [[0, 0], [50, 1]], amplitude = 0.2, frequency = 0.02 } }, \"free-slip\"] }");
  c.fluid +=
      "superficial_velocity = [0.01, 0, 0]\nbody_force = [1e-5, 2e-5, 0]\nbody_force_on_bodies = true\n"
      "body_force_over_time = { table = [[0, 0], [30, 1]] }\n";
  c.rest.replace(c.rest.find("[contacts]"), 10, "over_time = { table = [[0, 1], [40, 0.5]] }\n[contacts]");
  return c;
}

TEST(Driving, TheSameBitsOnADevice) {
  CaseText stream = crowd();
  stream.domain =
      domain_of({24, 20, 28},
                "{ x = [{ type = \"velocity-inlet\", velocity = [0.03, 0, 0], solid_for_bodies = false, "
                "over_time = { table = [[0, 0], [30, 1]] } }, { type = \"pressure-outlet\", solid_for_bodies "
                "= false }], y = \"periodic\", z = \"periodic\" }");
  for (const CaseText& driven : {driven_crowd(), stream}) {
    const auto hash = [&](const std::string& device) {
      Simulation simulation = driven.start(MPI_COMM_WORLD, {"run.device=" + device});
      simulation.run(40);
      return simulation.hash();
    };
    EXPECT_EQ(hash("host"), hash("cpu"));
  }
}

TEST(Driving, SameBitsForAnyBlocksAndRanks) {
  expect_one_hash(driven_crowd(), 70, {"[12, 10, 14]", "[24, 10, 7]"});
}

/// Before the first look that is used, between looks, and at one.
TEST(Driving, ARunGoesOnToTheSameBits) {
  for (const int steps : {9, 41, 48}) {
    Simulation simulation = driven_crowd().start(MPI_COMM_WORLD);
    simulation.run(steps);
    const Saved saved(simulation);
    const auto again = saved.go_on(simulation.setup());
    simulation.run(40);
    again->run(40);
    EXPECT_EQ(again->hash(), simulation.hash()) << steps;
    EXPECT_EQ(again->scene().flow->control()->force(rigid::Vec3::Zero()),
              simulation.scene().flow->control()->force(rigid::Vec3::Zero()));
  }
}

CaseText stirred_crowd() {
  CaseText c = crowd();
  c.bodies += body_of("box", 2,
                      "name = \"paddle\"\nposition = [12, 10, 14]\nmotion = { angular_velocity = 0.004, axis "
                      "= [0, 1, 2], amplitude = [0, 0, 1], frequency = 0.01 }");
  return c;
}

TEST(PrescribedBodies, SameBitsForAnyBlocksAndRanksAndInARunThatGoesOn) {
  expect_one_hash(stirred_crowd(), 60, {"[12, 10, 14]"});
  Simulation simulation = stirred_crowd().start(MPI_COMM_WORLD);
  simulation.run(25);
  expect_goes_on(simulation, 35);
}

}  // namespace
}  // namespace silt::coupler::testing
