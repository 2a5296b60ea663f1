// Bodies in a fluid: drag, buoyancy and rest, against theory.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "coupler/case/derived_table.hpp"
#include "tests/coupler/coupled_scenes.hpp"
#include "tests/world.hpp"

namespace silt::coupler {
namespace {

using rigid::Vec3;

// Zick and Homsy 1982, simple cubic array, phi = 0.064: K = 2.810.
TEST(CoupledStep, DragOfACubicArray) {
  const char* const positions[] = {"[8.13,8.31,7.87]", "[8.31,8.13,8.47]", "[8.2,8.4,8.1]",
                                   "[8.05,8.15,8.35]", "[8.42,7.71,8.27]", "[7.64,8.44,7.93]"};
  double sum = 0;
  for (const char* p : positions)
    sum += drag_coefficient(sphere_array({std::string("bodies[0].position=") + p}), MPI_COMM_WORLD);
  const double error = sum / std::size(positions) / 2.810198 - 1;
  if (tests::rank() == 0)
    printf("cubic array, phi 0.064, D = 7.94, 6 positions: mean error %.2f %%\n", 100 * error);
  EXPECT_LT(std::fabs(error), 0.01);
}

TEST(CoupledStep, DragDoesNotDependOnViscosity) {
  const auto k = [](const char* tau, const char* steps) {
    return drag_coefficient(sphere_array({tau, steps, "bodies[0].position=[8.13,8.31,7.87]"}),
                            MPI_COMM_WORLD);
  };
  const double one = k("fluid.relaxation_time=1.0", "run.steps=2500");
  EXPECT_NEAR(k("fluid.relaxation_time=0.6", "run.steps=12000") / one, 1, 1e-4);
  EXPECT_NEAR(k("fluid.relaxation_time=1.5", "run.steps=1500") / one, 1, 1e-4);
}

Case light_sphere(const std::string& scheme) {
  return read_case_text(R"(
title = "light"
[units]
system = "lattice"
[domain]
size = [32, 32, 64]
boundary = "no-slip"
[fluid]
relaxation_time = 0.6
[gravity]
acceleration = [0, 0, -4e-4]
[[shapes]]
name = "sphere"
type = "sphere"
diameter = 8
[[bodies]]
shape = "sphere"
density = 0.5
position = [16.3, 15.8, 12.2]
[run]
steps = 3000
)",
                        "light", {"coupling.wall_scheme=" + scheme});
}

// Half as dense as the fluid, at a relaxation time where explicit coupling is unstable: it rises and settles
// into a steady speed, a little below that of unbounded fluid (Schiller and Naumann; the walls are two
// diameters away).
TEST(CoupledStep, LightSphereRisesSteadilyWithAnyWallScheme) {
  for (const auto name : lbm::wall_scheme_names) {
    Simulation s(light_sphere(std::string(name)), MPI_COMM_WORLD);
    double speed[2] = {};
    for (int half = 0; half < 2; ++half) {
      while (s.steps_done() < 1500 + half * 500) s.step();
      double v = 0;
      for (std::size_t row = 0; row < s.bodies().owned; ++row) v += s.bodies().velocity[row][2];
      speed[half] = tests::sum_over_ranks(v);
    }
    const double unbounded = terminal_velocity(8, 0.5, 4e-4, 0.1 / 3);
    if (tests::rank() == 0)
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
       {"cli", "bouzidi", "parabolic"}) {  // plain bounce-back lets shut-in cells swing for ever
    Simulation s(heap({"coupling.wall_scheme=" + name}), MPI_COMM_WORLD);
    while (s.steps_done() < 2000) s.step();
    const double speed = s.look_at_flow().max_speed;
    double body = 0;
    for (std::size_t row = 0; row < s.bodies().owned; ++row)
      body = std::max(body, s.bodies().velocity[row].norm() + 4 * s.bodies().angular_velocity[row].norm());
    body = tests::largest_of_ranks(body);
    if (tests::rank() == 0)
      printf("heap at rest, %s: fastest fluid %.2g, fastest surface %.2g\n", name.c_str(), speed, body);
    EXPECT_LT(speed, 1e-3) << name;
  }
}

}  // namespace
}  // namespace silt::coupler
