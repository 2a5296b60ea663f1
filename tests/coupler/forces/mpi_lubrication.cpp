// A sphere that settles on a wall: the last cells of the gap.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>

#include "coupler/case/case.hpp"
#include "coupler/case/case_file.hpp"
#include "coupler/simulation.hpp"
#include "tests/coupler/case/mesh_case.hpp"
#include "tests/coupler/forces/approach_series.hpp"
#include "tests/world.hpp"

namespace silt::coupler::testing {
namespace {

constexpr double radius = 6, volume = 4. / 3 * M_PI * radius * radius * radius, viscosity = 1. / 3;

/// Largest relative deviation of the resistance from theory while the gap of a sphere of 12 cells to a wall
/// closes from 0.3 to 0.05 cells; by its weight it would move at 0.002 cells a step half a cell above the
/// wall, a side of the domain or the top of a plate of triangles. The sphere is mapped where it is: half-way
/// between layers a mapping tolerance of 0.015 adds half a percent.
double approach_error(double density, const std::string& lubrication = "true", double plate = 0) {
  constexpr double speed = 2e-3;
  const double drag =
      6 * M_PI * viscosity * radius * speed * silt::testing::approach_to_wall(1 + 0.5 / radius);
  const double gravity = -drag / (volume * (density - 1)), weight = volume * (density - 1) * gravity;
  CaseText c;
  c.domain = domain_of({36, 36, plate > 0 ? 34 : 30}, R"({ x = "periodic", y = "periodic", z = "no-slip" })");
  c.fluid = "[fluid]\nrelaxation_time = 1.5\nprecision = \"double\"\n";
  c.rest = fmt::format("[gravity]\nacceleration = [0, 0, {}]\n", gravity);
  Files files;
  if (plate > 0) {
    files["plate.ply"] = ply_of(rigid::testing::cuboid_mesh({-5, -5, -1}, {41, 41, plate}));
    c.rest += "[[walls]]\ntype = \"mesh\"\nfile = \"plate.ply\"\nsolid = \"inside\"\n";
  }
  c.shapes = sphere_of("sphere", 2 * radius);
  c.bodies =
      body_of("sphere", density,
              fmt::format("position = [18.31, 17.83, {}]\nvelocity = [0, 0, {}]", plate + 6.6, -speed));
  Simulation s(read_with(c, files, {"coupling.lubrication=" + lubrication, "coupling.remap_tolerance=0"}),
               MPI_COMM_WORLD);
  double worst = 0, gap = 1;
  while (gap > 0.05 && s.steps_done() < 10000) {
    s.step();
    double mine[2] = {0, 0};
    if (s.bodies().owned > 0)
      mine[0] = s.bodies().position[0][2] - plate - 6, mine[1] = s.bodies().velocity[0][2];
    gap = tests::sum_over_ranks(mine[0]);
    if (gap > 0.3) continue;
    const double resistance = weight / (6 * M_PI * viscosity * radius * tests::sum_over_ranks(mine[1]));
    worst = std::max(worst, std::abs(resistance / silt::testing::approach_to_wall(1 + gap / radius) - 1));
  }
  EXPECT_LT(gap, 0.05);
  return worst;
}

TEST(Lubrication, ASphereSettlesOnAWallAsBrennersSeriesSays) {
  for (const double density : {8.0, 1.5}) {
    const double error = approach_error(density);
    if (tests::rank() == 0) printf("density %g: %.1f %%\n", density, 100 * error);
    EXPECT_LT(error, 0.07) << density;  // position in the lattice; at 8, inertia
  }
}

/// It may lie anywhere between the nodes of the lattice, worst for what is resolved half-way between two
/// layers.
TEST(Lubrication, ASphereSettlesOnAPlateOfTriangles) {
  for (const auto& [plate, allowed] : {std::pair(3.0, 0.07), {3.25, 0.07}, {3.5, 0.15}, {3.75, 0.07}}) {
    const double error = approach_error(8, "true", plate);
    if (tests::rank() == 0) printf("plate at %g: %.1f %%\n", plate, 100 * error);
    EXPECT_LT(error, allowed) << plate;
  }
}

TEST(Lubrication, WithoutItTheLatticeLetsTheSphereFall) {
  EXPECT_GT(approach_error(8, "false"), 0.5);
}

/// The coupling in time asks for the velocity of the body beyond a film on the owner's rank, where there need
/// be no other copy of it: in a bed of 225 spheres this shows in a few steps on four ranks and on eight.
TEST(Films, OfADenseBedAreTheSameOnAnyRanks) {
  const auto hash = [](MPI_Comm comm) {
    Simulation bed(read_case(std::filesystem::path(SILT_SOURCE_DIR) / "cases/fluidised-bed"), comm);
    for (int step = 0; step < 15; ++step) bed.step();
    EXPECT_GT(bed.counters().lubricated_contacts, 1000u);
    return bed.hash();
  };
  EXPECT_EQ(hash(MPI_COMM_WORLD), tests::alone([&] { return hash(MPI_COMM_SELF); }));
}

}  // namespace
}  // namespace silt::coupler::testing
