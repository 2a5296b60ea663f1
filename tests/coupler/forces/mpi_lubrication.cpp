// A sphere that settles on a wall: the last cells of the gap.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "tests/coupler/coupled_scenes.hpp"
#include "tests/coupler/forces/approach_series.hpp"
#include "tests/world.hpp"

namespace silt::coupler {
namespace {

using rigid::Vec3;

/// A sphere of 12 cells about to settle on a wall, so that it would move at `speed` half a cell above it.
Case settling_on_a_wall(double density, double speed, const std::vector<std::string>& overrides = {}) {
  constexpr double viscosity = 1. / 3, radius = 6, volume = 4. / 3 * M_PI * radius * radius * radius;
  const double weight = 6 * M_PI * viscosity * radius * speed * testing::approach_to_wall(1 + 0.5 / radius);
  Case scene = read_case_text(R"(
title = "settling on a wall"
[units]
system = "lattice"
[domain]
size = [36, 36, 30]
boundary = { x = "periodic", y = "periodic", z = "no-slip" }
[fluid]
relaxation_time = 1.5
precision = "double"
[gravity]
acceleration = [0, 0, -1]
[[shapes]]
name = "sphere"
type = "sphere"
diameter = 12
[[bodies]]
shape = "sphere"
density = 2
position = [18.31, 17.83, 6.6]
[run]
steps = 10000
)",
                              "settling", overrides);
  scene.bodies[0].density = density;
  scene.bodies[0].velocity = {0, 0, -speed};
  scene.gravity = {0, 0, -weight / (volume * (density - 1))};
  return scene;
}

/// Largest relative deviation of the resistance from theory while the gap closes from 0.3 to 0.05 cells.
double approach_error(const Case& scene) {
  Simulation s(scene, MPI_COMM_WORLD);
  const double weight = 4. / 3 * M_PI * 216 * (scene.bodies[0].density - 1) * scene.gravity[2];
  double worst = 0, gap = 1;
  while (gap > 0.05 && s.steps_done() < scene.steps) {
    s.step();
    double mine[2] = {0, 0};
    if (s.bodies().owned > 0) mine[0] = s.bodies().position[0][2] - 6, mine[1] = s.bodies().velocity[0][2];
    gap = tests::sum_over_ranks(mine[0]);
    if (gap > 0.3) continue;
    const double resistance = weight / (6 * M_PI / 3 * 6 * tests::sum_over_ranks(mine[1]));
    worst = std::max(worst, std::abs(resistance / testing::approach_to_wall(1 + gap / 6) - 1));
  }
  EXPECT_LT(gap, 0.05);
  return worst;
}

TEST(Lubrication, ASphereSettlesOnAWallAsBrennersSeriesSays) {
  for (const double density : {8.0, 1.5}) {
    const double error = approach_error(settling_on_a_wall(density, 2e-3));
    if (tests::rank() == 0) printf("density %g: %.1f %%\n", density, 100 * error);
    EXPECT_LT(error, 0.07) << density;  // position in the lattice; at 8, inertia
  }
}

TEST(Lubrication, WithoutItTheLatticeLetsTheSphereFall) {
  Case scene = settling_on_a_wall(8, 2e-3, {"coupling.lubrication=false"});
  EXPECT_GT(approach_error(scene), 0.5);
}

}  // namespace
}  // namespace silt::coupler
