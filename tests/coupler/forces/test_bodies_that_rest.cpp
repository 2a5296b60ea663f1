// What a stream does to bodies in contact: those that rest feel what fixed ones feel, and those that roll
// are as fast whatever their mass.
#include <gtest/gtest.h>

#include "coupler/simulation.hpp"
#include "tests/coupler/case/case_text.hpp"

namespace silt::coupler::testing {
namespace {

/// A box on the floor of a channel, not all symmetric to the stream.
CaseText box_in_a_stream(double density, const std::string& motion) {
  CaseText c;
  c.domain =
      domain_of({28, 20, 18}, "{ x = \"periodic\", y = \"periodic\", z = [\"no-slip\", \"no-slip\"] }");
  c.fluid = "[fluid]\nrelaxation_time = 0.65\nbody_force = [1e-5, 2e-6, 0]\n";
  c.rest = "[gravity]\nacceleration = [0, 0, -4e-3]\n[contacts]\nrestitution = 0\nfriction = 0.8\n";
  c.shapes = shape_of("box", "box", "edges = [7, 6, 8]");
  c.bodies = body_of("box", density, "position = [10, 10, 4]\nmotion = \"" + motion + "\"");
  return c;
}

BodyLoad load_after(const CaseText& c, int steps) {
  Simulation s = c.start(MPI_COMM_SELF);
  s.run(steps);
  return s.last_loads()[0];
}

TEST(BodiesThatRest, FeelWhatFixedOnesFeel) {
  constexpr int steps = 3000;
  for (const double density : {1.1, 3.0}) {
    const BodyLoad fixed = load_after(box_in_a_stream(density, "fixed"), steps),
                   held = load_after(box_in_a_stream(density, "free"), steps);
    EXPECT_GT(fixed.torque.norm(), fixed.force.norm());
    EXPECT_LT((held.force - fixed.force).norm(), 1e-4 * fixed.force.norm()) << density;
    EXPECT_LT((held.torque - fixed.torque).norm(), 1e-4 * fixed.torque.norm()) << density;
  }
}

/// The speed of a ball that rolls along the floor, or the ceiling if it floats, pressed on alike, once it is
/// steady: the mean over some ten cells, since a light one feels where it is in the lattice.
double rolling_speed(double density, bool lubrication) {
  CaseText c;
  c.domain =
      domain_of({24, 16, 16}, "{ x = \"periodic\", y = \"periodic\", z = [\"no-slip\", \"no-slip\"] }");
  c.fluid = "[fluid]\nrelaxation_time = 0.65\nbody_force = [1e-5, 0, 0]\n";
  if (!lubrication) c.fluid += "[coupling]\nlubrication = false\n";
  c.rest = "[gravity]\nacceleration = [0, 0, " + std::to_string(-1e-3 / (density - 1)) +
           "]\n[contacts]\nrestitution = 0\nfriction = 0.4\n";
  c.shapes = shape_of("ball", "sphere", "radius = 4");
  c.bodies = body_of("ball", density, density > 1 ? "position = [8, 8, 4]" : "position = [8, 8, 12]");
  Simulation s = c.start(MPI_COMM_SELF);
  s.run(4000);
  constexpr int steps = 8000;
  double speed = 0;
  for (int t = 0; t < steps; ++t) {
    s.step();
    speed += s.scene().bodies.velocity[0].x() / steps;
  }
  return speed;
}

TEST(BodiesThatRoll, AreAsFastWhateverTheirMass) {
  for (const bool lubrication : {true, false}) {
    const double heavy = rolling_speed(2.0, lubrication);
    EXPECT_GT(heavy, 1e-4);
    for (const double light : {0.05, 0.3})
      EXPECT_NEAR(rolling_speed(light, lubrication), heavy, 0.02 * heavy) << light << lubrication;
  }
}

}  // namespace
}  // namespace silt::coupler::testing
