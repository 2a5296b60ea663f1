// Fluid and bodies together: what is kept, momentum and mass, and what a body that drifts along feels.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "silt/simulation.hpp"
#include "tests/silt/coupled_scenes.hpp"
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
    single.emplace_back("fluid.precision=single");
    const double in_double = momentum_drift(overrides, 1000), in_single = momentum_drift(single, 1000);
    if (tests::rank() == 0)
      printf("%s: exact form, drift %.2g in double, %.2g in single\n", overrides.back().c_str(), in_double,
             in_single);
    EXPECT_LT(in_double, 1e-11) << overrides.back();
    EXPECT_LT(in_single, 1e-6) << overrides.back();
  }
}

/// A rod that turns, two balls that pass it on either side and a free one: none comes to touch another.
CaseText passing_bodies() {
  CaseText c;
  c.domain =
      "[domain]\nsize = [28, 26, 20]\nboundary.x = \"periodic\"\nboundary.y = \"periodic\"\n"
      "boundary.z = \"no-slip\"\n";
  c.fluid = "[fluid]\nrelaxation_time = 0.6\n";
  c.rest = "[gravity]\nacceleration = [0, 0, -1e-4]\n";
  c.shapes = shape_of("rod", "capsule", "radius = 2\nlength = 5") + sphere_of("ball", 5);
  c.bodies =
      body_of("rod", 2, R"(motion = "prescribed"
position = [14.1, 13.2, 6.3]
orientation = { axis = [0, 1, 0], degrees = 90 }
angular_velocity = [0, 0, 0.008])") +
      body_of("ball", 2, "motion = \"prescribed\"\nposition = [4.1, 4.2, 6.3]\nvelocity = [0.05, 0, 0]") +
      body_of("ball", 2,
              "motion = \"prescribed\"\nposition = [24.3, 22.2, 6]\nvelocity = [-0.03, 0, 0.003]") +
      body_of("ball", 1.3, "position = [10.2, 3.1, 14.8]");
  return c;
}

/// A ball that passes another one and the floor a quarter of a cell from both, and one that falls on the
/// floor.
CaseText brushing_bodies() {
  CaseText c = passing_bodies();
  c.shapes = sphere_of("ball", 6);
  c.bodies =
      body_of("ball", 2, "motion = \"fixed\"\nposition = [14.1, 9.2, 3.4]") +
      body_of("ball", 2, "motion = \"prescribed\"\nposition = [5.1, 15.4, 3.25]\nvelocity = [0.05, 0, 0]") +
      body_of("ball", 4, "position = [20.2, 21.1, 4.2]");
  return c;
}

/// How the mass of the fluid changed, but for what it will get back and what cells took that no neighbour
/// could have, as a share.
double lost_mass(const CaseText& scene, const std::string& precision, int steps) {
  Simulation s = scene.start(MPI_COMM_WORLD, {"fluid.precision=" + precision});
  const double before = s.balance().mass_deviation;
  s.run(steps);
  EXPECT_GT(tests::sum_over_ranks(double(s.counters().uncovered)), 100);
  const FlowTotals now = s.checked_totals();
  EXPECT_GT(now.max_density - now.min_density, 1e-4) << "a fluid that nobody presses loses nothing";
  const double all = s.balance().mass_deviation, taken = double(s.mass_taken()) * lbm::mass_quantum;
  EXPECT_LT(std::fabs(all - now.mass_deviation), 1e-6 * double(now.fluid_cells))
      << "is what a step owes given back in the next?";
  return (all - before + taken) / double(now.fluid_cells);
}

// Each sum of a cell's populations is rounded to a quantum of 2^-40 when it changes sides or is counted.
TEST(CoupledStep, NeitherWallsNorCellsThatChangeSidesTakeMass) {
  for (const std::string scheme : {"multireflection", "cli"})
    for (const bool touching : {false, true}) {
      CaseText scene = touching ? brushing_bodies() : passing_bodies();
      scene.rest += "[coupling]\nwall_scheme = \"" + scheme + "\"\n";
      const double in_double = lost_mass(scene, "double", 500), in_single = lost_mass(scene, "single", 500);
      if (tests::rank() == 0)
        printf("%s%s: mass lost in 500 steps, %.2g in double, %.2g in single\n", scheme.c_str(),
               touching ? ", touching" : "", in_double, in_single);
      EXPECT_LT(std::fabs(in_double), 1e-12) << scheme << touching;
      EXPECT_LT(std::fabs(in_single), 1e-9) << scheme << touching;
    }
}

/// A star that moves with a fluid that moves as a whole.
CaseText star_in_the_stream() {
  CaseText c;
  c.domain = domain_of({20, 18, 16});
  c.fluid += "precision = \"double\"\ninitial = { type = \"uniform\", velocity = [0.05, 0.03, -0.02] }\n";
  c.shapes = shape_of("star", "compound",
                      "parts = [ { type = \"capsule\", radius = 2, length = 6, orientation = [1, 0.2, 0] },\n"
                      "{ type = \"capsule\", radius = 2, length = 6, orientation = [0, 1, 0.3] } ]");
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
