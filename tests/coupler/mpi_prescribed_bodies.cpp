// Bodies that move as a function of time in a fluid, or are held by locked axes.
#include <fmt/format.h>
#include <gtest/gtest.h>
#include <mpi.h>

#include <cmath>
#include <numbers>

#include "silt/case/case.hpp"
#include "silt/results/quantities.hpp"
#include "tests/coupler/coupled_scenes.hpp"
#include "tests/coupler/same_bits.hpp"
#include "tests/world.hpp"

namespace silt::coupler::testing {
namespace {

using std::numbers::pi;

/// The fluid's force on a sphere that oscillates in fluid at rest (L. D. Landau, E. M. Lifshitz, Fluid
/// Mechanics, paragraph 24): F = -6 pi mu a (1 + a/d) u - 2/3 pi a^3 rho (1 + 9 d / (2 a)) du/dt, with the
/// penetration depth d = sqrt(2 nu / w).
TEST(PrescribedBodies, AnOscillatingSphereFeelsDragAndAddedMassAsTheorySays) {
  constexpr double a = 5, nu = 0.05, depth = 2.5, amplitude = 0.2;
  const double w = 2 * nu / (depth * depth);
  CaseText c;
  c.domain = domain_of({56, 56, 56}, "\"no-slip\"");
  c.fluid = "[fluid]\nkinematic_viscosity = 0.05\n";
  c.shapes = sphere_of("ball", 2 * a);
  c.bodies = body_of("ball", 1,
                     fmt::format("position = [28, 28, 28]\nmotion = {{ amplitude = [{}, 0, 0], "
                                 "frequency = {:.17g} }}",
                                 amplitude, w / (2 * pi)));
  Simulation simulation = c.start(MPI_COMM_WORLD);
  const int period = int(std::lround(2 * pi / w));
  simulation.run(period + period / 2);
  double in_phase = 0, before_it = 0;  // of the velocity
  for (int i = 0; i < period; ++i) {
    simulation.step();
    double force = 0;
    for (const BodyLoad& load : simulation.last_loads()) force += load.force[0];
    force = tests::sum_over_ranks(force);
    const double phase = w * (double(simulation.steps_done()) - 0.5);
    in_phase += 2. / period * force * std::cos(phase);
    before_it += 2. / period * force * std::sin(phase);
  }
  const double u = amplitude * w;
  const double drag = -6 * pi * nu * a * (1 + a / depth) * u;
  const double added = 2. / 3 * pi * a * a * a * (1 + 4.5 * depth / a) * u * w;
  EXPECT_NEAR(in_phase, drag, 0.05 * std::abs(drag));
  EXPECT_NEAR(before_it, added, 0.05 * added);
}

CaseText stirred_crowd() {
  CaseText c = crowd();
  c.bodies +=
      body_of("box", 2,
              "name = \"paddle\"\nposition = [12, 10, 14]\nmotion = { angular_velocity = 0.004, axis = [0, "
              "1, 2], amplitude = [0, 0, 1], frequency = 0.01 }");
  return c;
}

TEST(PrescribedBodies, SameBitsForAnyBlocksAndRanksAndInARunThatGoesOn) {
  expect_one_hash(stirred_crowd(), 60, {"[12, 10, 14]"});
  Simulation simulation = stirred_crowd().start(MPI_COMM_WORLD);
  simulation.run(25);
  expect_goes_on(simulation, 35);
}

/// A free sphere all of whose axes are locked feels what a fixed one does.
TEST(PrescribedBodies, ALockedSphereHasTheForceOfAFixedOne) {
  const auto force = [](const std::string& motion) {
    CaseText c = sphere_array();
    c.bodies = body_of("sphere", 1.5, "position = [8.2, 7.9, 8.1]\n" + motion);
    c.run = "[run]\nsteps = 5000\n[[quantities]]\nname = \"f\"\ntype = \"fluid-force\"\naxis = \"x\"\n";
    return c.values(MPI_COMM_WORLD)[0];
  };
  const double fixed = force("motion = \"fixed\"");
  EXPECT_GT(fixed, 1e-6);
  EXPECT_NEAR(force("locked = [\"x\", \"y\", \"z\", \"rotation x\", \"rotation y\", \"rotation z\"]"), fixed,
              1e-7 * fixed);
}

}  // namespace
}  // namespace silt::coupler::testing
