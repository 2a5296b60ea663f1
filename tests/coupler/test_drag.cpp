// Bodies in a fluid: drag, buoyancy and rest, against theory.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "coupler/case/case_check.hpp"
#include "coupler/simulation.hpp"
#include "lbm/wall_scheme.hpp"
#include "tests/coupler/coupled_scenes.hpp"

namespace silt::coupler::testing {
namespace {

using rigid::Vec3;

/// F / (6 pi mu a U) of the array, F: wall force + body force on the sphere's volume, U: mean over the whole
/// cube.
double drag_coefficient(const std::string& position, double tau = 1, int steps = 2500,
                        const std::string& scheme = "multireflection") {
  Simulation s = sphere_array().start(
      MPI_COMM_SELF, {fmt::format("fluid.relaxation_time={}", tau), "bodies[0].position=" + position,
                      "coupling.wall_scheme=" + scheme});
  s.run(steps);
  double force = 0;
  for (const auto& load : s.last_loads()) force += load.force[0];
  const FlowTotals t = s.look_at_flow();
  const double a = array_diameter / 2, g = array_force, viscosity = (tau - 0.5) / 3;
  const double u = (t.momentum[0] + 0.5 * g * double(t.fluid_cells)) / std::pow(array_edge, 3);
  return (force + g * 4 * M_PI / 3 * a * a * a) / (6 * M_PI * viscosity * a * u);
}

// Zick and Homsy 1982, simple cubic array, phi = 0.064: K = 2.810.
TEST(CoupledStep, DragOfACubicArray) {
  const char* const positions[] = {"[8.13,8.31,7.87]", "[8.31,8.13,8.47]", "[8.2,8.4,8.1]",
                                   "[8.05,8.15,8.35]", "[8.42,7.71,8.27]", "[7.64,8.44,7.93]"};
  double sum = 0;
  for (const char* p : positions) sum += drag_coefficient(p);
  const double error = sum / std::size(positions) / 2.810198 - 1;
  printf("cubic array, phi 0.064, D = 7.94, 6 positions: mean error %.2f %%\n", 100 * error);
  EXPECT_LT(std::fabs(error), 0.01);
}

// Nor on the relaxation time, with Lambda given; under multireflection as long as its share is whole.
TEST(CoupledStep, DragDoesNotDependOnViscosity) {
  const auto expect_same = [](const std::string& scheme, double low, int steps) {
    const auto k = [&](double tau, int n) { return drag_coefficient("[8.13,8.31,7.87]", tau, n, scheme); };
    const double one = k(1, 2500);
    EXPECT_NEAR(k(low, steps) / one, 1, 1e-4) << scheme;
    EXPECT_NEAR(k(1.5, 1500) / one, 1, 1e-4) << scheme;
  };
  expect_same("parabolic", 0.6, 12000);
  expect_same("multireflection", 0.8, 4200);
}

CaseText light_sphere() {
  CaseText c;
  c.domain = domain_of({32, 32, 64}, "\"no-slip\"");
  c.fluid = "[fluid]\nrelaxation_time = 0.6\n";
  c.rest = "[gravity]\nacceleration = [0, 0, -4e-4]\n";
  c.bodies = body_of("ball", 0.5, "position = [16.3, 15.8, 12.2]");
  return c;
}

// Half as dense as the fluid, at a relaxation time where explicit coupling is unstable: it rises and settles
// into a steady speed, a little below that of unbounded fluid (Schiller and Naumann; the walls are two
// diameters away).
TEST(CoupledStep, LightSphereRisesSteadilyWithAnyWallScheme) {
  for (const auto name : lbm::wall_scheme_names) {
    Simulation s = light_sphere().start(MPI_COMM_SELF, {"coupling.wall_scheme=" + std::string(name)});
    double speed[2] = {};
    for (int half = 0; half < 2; ++half) {
      while (s.steps_done() < 1500 + half * 500) s.step();
      double v = 0;
      for (std::size_t row = 0; row < s.bodies().owned; ++row) v += s.bodies().velocity[row][2];
      speed[half] = v;
    }
    const double unbounded = terminal_velocity(8, 0.5, 4e-4, 0.1 / 3);
    printf("light sphere, %s: %.5f, unbounded fluid %.5f\n", std::string(name).c_str(), speed[1],
           std::fabs(unbounded));
    EXPECT_NEAR(speed[1] / speed[0], 1, 0.05);
    EXPECT_LT(speed[1], std::fabs(unbounded));
    EXPECT_GT(speed[1], 0.7 * std::fabs(unbounded));
  }
}

// Gravity would speed each body up by 1.7e-3 in a step if nothing held it. Its contacts do, so its surface
// must not tell the fluid that it falls: that drove the fluid at 7e-3, under any scheme. Cells shut in
// between the bodies must not keep what they had at the start either: that left 2e-3.
TEST(CoupledStep, FluidBetweenBodiesAtRestComesToRest) {
  for (const std::string name :
       {"cli", "parabolic"}) {  // plain bounce-back lets shut-in cells swing for ever
    Simulation s = heap().start(MPI_COMM_SELF, {"coupling.wall_scheme=" + name});
    while (s.steps_done() < 2000) s.step();
    const double speed = s.look_at_flow().max_speed;
    double body = 0;
    for (std::size_t row = 0; row < s.bodies().owned; ++row)
      body = std::max(body, s.bodies().velocity[row].norm() + 4 * s.bodies().angular_velocity[row].norm());
    printf("heap at rest, %s: fastest fluid %.2g, fastest surface %.2g\n", name.c_str(), speed, body);
    EXPECT_LT(speed, 1e-3) << name;
  }
}

}  // namespace
}  // namespace silt::coupler::testing
