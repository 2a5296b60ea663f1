// Fluid and bodies together: what is kept, momentum and mass, and what a body that drifts along feels.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "coupler/simulation.hpp"
#include "tests/coupler/coupled_scenes.hpp"
#include "tests/world.hpp"

namespace silt::coupler::testing {
namespace {

using rigid::Vec3;

double momentum_drift(const Overrides& overrides, int steps) {
  Simulation s = free_spheres().start(MPI_COMM_WORLD, overrides);
  const Balance before = s.balance();
  while (s.steps_done() < steps) s.step();
  EXPECT_GT(s.counters().uncovered, 0u);
  return (s.balance().momentum - before.momentum).norm() / before.momentum_scale;
}

TEST(CoupledStep, ExactFormConservesMomentum) {
  // explicit: heavier bodies; those of density 1.5 and 2 stir the fluid to 1.2 cells a step (unstable)
  const std::vector<std::string> heavy{"bodies[0].density=4", "bodies[1].density=4", "bodies[2].density=4",
                                       "coupling.time=explicit"};
  for (const auto& overrides : {std::vector<std::string>{"coupling.time=implicit"}, heavy}) {
    std::vector<std::string> single = overrides;
    single.push_back("fluid.precision=single");
    const double in_double = momentum_drift(overrides, 1000), in_single = momentum_drift(single, 1000);
    if (tests::rank() == 0)
      printf("%s: exact form, drift %.2g in double, %.2g in single\n", overrides.back().c_str(), in_double,
             in_single);
    EXPECT_LT(in_double, 1e-11) << overrides.back();
    EXPECT_LT(in_single, 1e-6) << overrides.back();
  }
}

/// A closed box full of spheres that a turning rod stirs.
CaseText stirred() {
  CaseText c;
  c.domain = domain_of({20, 20, 20}, "\"no-slip\"");
  c.fluid = "[fluid]\nrelaxation_time = 0.6\n";
  c.rest = "[gravity]\nacceleration = [0, 0, -1e-4]\n";
  c.shapes = shape_of("rod", "capsule", "radius = 2\nlength = 7") + sphere_of("ball", 5);
  c.bodies = body_of("rod", 2, R"(motion = "prescribed"
position = [10.1, 10.2, 10.3]
axis_angle = { axis = [0, 1, 0], degrees = 90 }
angular_velocity = [0, 0, 0.008])") +
             fill_of("ball", 1.3, 12, "seed = 3");
  return c;
}

/// The mass of the fluid but for what the mass correction takes out in the next step, as a share.
double unseen_mass(const std::string& precision, int steps) {
  Simulation s = stirred().start(MPI_COMM_WORLD, {"fluid.precision=" + precision});
  const FlowTotals before = s.look_at_flow();
  s.run(steps);
  EXPECT_GT(tests::sum_over_ranks(double(s.counters().uncovered)), 100);
  const FlowTotals now = s.look_at_flow();
  const double known = double(s.scene().flow->account().mass_correction().surplus) * 0x1p-40;
  return (now.mass_deviation - before.mass_deviation - known) / double(now.fluid_cells);
}

TEST(CoupledStep, MassCorrectionKnowsTheMassOfTheFluid) {
  const double in_double = unseen_mass("double", 500), in_single = unseen_mass("single", 500);
  if (tests::rank() == 0)
    printf("mass that the correction does not know: %.2g in double, %.2g in single\n", in_double, in_single);
  EXPECT_LT(std::fabs(in_double), 1e-11);
  EXPECT_LT(std::fabs(in_single), 1e-9);
}

/// A star that moves with a fluid that moves as a whole.
CaseText star_in_the_stream() {
  CaseText c;
  c.domain = domain_of({20, 18, 16});
  c.fluid += "precision = \"double\"\ninitial = { type = \"uniform\", velocity = [0.05, 0.03, -0.02] }\n";
  c.rest = "[coupling]\nmass_correction = false\n";
  c.shapes = shape_of("star", "compound",
                      "parts = [ { type = \"capsule\", radius = 2, length = 6, axis = [1, 0.2, 0] },\n"
                      "{ type = \"capsule\", radius = 2, length = 6, axis = [0, 1, 0.3] } ]");
  c.bodies = body_of("star", 1, R"(motion = "prescribed"
velocity = [0.05, 0.03, -0.02]
position = [8.2, 7.7, 8.4])");
  return c;
}

/// Largest force or torque over 100 steps on the star.
double largest_load_in_still_fluid(const std::string& form) {
  Simulation s = star_in_the_stream().start(MPI_COMM_WORLD, {"coupling.force=" + form});
  double largest = 0;
  for (int t = 0; t < 100; ++t) {
    s.step();
    for (const BodyLoad& load : s.last_loads())
      largest = std::max({largest, load.force.norm(), load.torque.norm()});
  }
  EXPECT_GT(s.counters().uncovered, 0u);
  return tests::largest_of_ranks(largest);
}

// Whatever cells it covers and leaves: 0.06 a cell would be felt if their momentum were handed over as it is.
TEST(CoupledStep, ABodyThatMovesWithTheFluidFeelsNothing) {
  EXPECT_LT(largest_load_in_still_fluid("exact"), 1e-9);
  EXPECT_LT(largest_load_in_still_fluid("galilean"), 0.03);
}

TEST(CoupledStep, DefaultFormDriftIsSmallButNotZero) {
  const double drift = momentum_drift({"coupling.force=galilean"}, 1000);
  if (tests::rank() == 0) printf("galilean form: drift %.3g of the bodies' momentum in 1000 steps\n", drift);
  EXPECT_LT(drift, 0.05);
  EXPECT_GT(drift, 1e-9);  // else the two forms would be the same code
}

}  // namespace
}  // namespace silt::coupler::testing
