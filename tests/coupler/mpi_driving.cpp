// The flows that a run may begin with, and driven ones: with the same bits on any ranks and in runs that go
// on.
#include <gtest/gtest.h>
#include <mpi.h>

#include <cmath>
#include <numbers>

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

using std::numbers::e;
using std::numbers::pi;

/// Fluid alone in a periodic box; quantities are its energy and dissipation at the start, and the dissipation
/// a step later: a stress that is not that of the flow changes within a step.
CaseText flow_of(const std::array<int, 3>& cells, const std::string& initial, double tau = 0.8) {
  CaseText c;
  c.domain = domain_of(cells);
  c.fluid = "[fluid]\nprecision = \"double\"\nrelaxation_time = " + std::to_string(tau) + "\ninitial = { " +
            initial + " }\n";
  c.shapes.clear();
  c.bodies.clear();
  c.run = "[run]\nsteps = 1\n";
  for (const char* what :
       {"\"kinetic-energy\"\ntime = 0", "\"dissipation\"\ntime = 0", "\"dissipation\"\ntime = 1"})
    c.run += "[[quantities]]\nname = \"q" + std::to_string(c.run.size()) + "\"\ntype = " + what + "\n";
  return c;
}

/// Over the plane: the mean of u.u/2 is s^2 e pi R^2 / 2 A, that of 2 nu S:S is nu times that of the
/// vorticity's square, 2 pi e s^2 / A. The tails that the box cuts off are e^-28 of it.
TEST(InitialFlow, VortexHasItsEnergyAndDissipation) {
  const double swirl = 0.02, radius = 6, viscosity = 0.1, area = 64 * 64;
  const auto found = flow_of({64, 64, 8}, "type = \"vortex\", velocity = [0, 0, 0], swirl = 0.02, radius = 6")
                         .values(MPI_COMM_WORLD);
  EXPECT_NEAR(found[0] / (swirl * swirl * e * pi * radius * radius / (2 * area)), 1, 1e-6);
  EXPECT_NEAR(found[1] / (viscosity * 2 * pi * e * swirl * swirl / area), 1, 1e-4);
  EXPECT_NEAR(found[2] / found[1], 1, 0.03);
}

/// Means over the layers' thickness d = H/s, of four half layers: that of
/// tanh^2 is 1 - 4 d/H, of sech^4 it is 4 . 2/3 d/H.
TEST(InitialFlow, ShearLayersHaveTheirEnergyAndDissipation) {
  const double speed = 0.05, steepness = 20, share = 0.05, viscosity = 0.1, height = 64;
  const auto found = flow_of({64, 64, 8}, "type = \"shear-layer\", velocity = [0.05, 0, 0], steepness = 20")
                         .values(MPI_COMM_WORLD);
  const double thickness = height / steepness, wave = share * speed, k = 2 * pi / 64;
  const double energy = speed * speed / 2 * (1 - 4 / steepness) + wave * wave / 4;
  const double shear = speed / thickness * speed / thickness * 8 / (3 * steepness) + wave * wave * k * k / 2;
  EXPECT_NEAR(found[0] / energy, 1, 1e-3);
  EXPECT_NEAR(found[1] / (viscosity * shear), 1, 1e-3);
  EXPECT_NEAR(found[2] / found[1], 1, 0.06);
}

/// Each component of each cell is uniform between -a and a: the mean of u.u/2
/// is a^2/2, to three deviations of a mean over 32768 cells.
TEST(InitialFlow, NoiseIsBoundedAndTheSameOnAnyRanks) {
  const double noise = 0.01;
  const CaseText c = flow_of({32, 32, 32}, "type = \"rest\", noise = 0.01");
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
