// Free bodies of triangles in a fluid: cells, mass and momentum of a torus, and a ball of triangles that
// moves as the sphere of its volume.
#include <gtest/gtest.h>
#include <mpi.h>

#include <cmath>
#include <numbers>

#include "coupler/simulation.hpp"
#include "tests/coupler/case/mesh_case.hpp"
#include "tests/coupler/solid_cells.hpp"
#include "tests/world.hpp"

namespace silt::coupler::testing {
namespace {

using rigid::Vec3;

constexpr double density = 2;

/// One body that moves and turns in a periodic box.
CaseText alone(const std::string& shape, const std::string& precision = "double") {
  CaseText c;
  c.domain = domain_of({28, 26, 24});
  c.fluid = "[fluid]\nrelaxation_time = 0.8\nprecision = \"" + precision + "\"\n";
  c.rest = "[coupling]\nforce = \"exact\"\nmass_correction = false\n";
  c.shapes = shape;
  c.bodies =
      body_of("body", density,
              "orientation = [0.8, 0.3, -0.4, 0.5]\nposition = [2.3, 24.1, 13.7]\nvelocity = [0.03, 0.01, "
              "-0.02]\nangular_velocity = [0.004, 0.003, -0.005]");
  return c;
}

const std::string torus_shape = shape_of("body", "mesh", "file = \"torus.ply\"");
const rigid::TriangleMesh torus = rigid::testing::torus_mesh(6, 2.5, 40, 20);
Files torus_file() {
  return {{"torus.ply", ply_of(torus)}};
}

TEST(MeshBodies, ATorusCoversItsVolumeAndKeepsMomentum) {
  Simulation s(read_with(alone(torus_shape), torus_file(), {"domain.blocks=[14,13,12]"}), MPI_COMM_WORLD);
  const Vec3 before = s.balance().momentum;
  const double volume = torus.mass_properties().volume;
  double mass = 0, cells = 0;
  for (std::size_t row = 0; row < s.bodies().owned; ++row) mass += s.bodies().mass[row];
  EXPECT_NEAR(tests::sum_over_ranks(mass), density * volume, 1e-9 * volume);
  const int looks = 20, steps_a_look = 5;
  for (int look = 0; look < looks; ++look) {
    cells += solid_cells(s) / looks;
    for (int t = 0; t < steps_a_look; ++t) s.step();
  }
  EXPECT_NEAR(cells / volume, 1, 0.01) << "20 places, 1 or 2 % each";
  EXPECT_GT(s.counters().uncovered, 0u);
  const double scale = density * volume * Vec3(0.03, 0.01, -0.02).norm();
  EXPECT_LT((s.balance().momentum - before).norm(), 1e-11 * scale);
}

TEST(MeshBodies, SameBitsOnAnyNumberOfRanksAndBlocks) {
  for (const std::string precision : {"single", "double"})
    for (const std::string force : {"galilean", "exact"}) {
      const auto hash = [&](const std::string& blocks, MPI_Comm comm) {
        Simulation s(read_with(alone(torus_shape, precision), torus_file(),
                               {"domain.blocks=" + blocks, "coupling.force=" + force}),
                     comm);
        s.run(60);
        return s.hash();
      };
      const auto one = tests::alone([&] { return hash("\"auto\"", MPI_COMM_SELF); });
      EXPECT_EQ(hash("[14,13,12]", MPI_COMM_WORLD), one) << precision << " " << force;
      EXPECT_EQ(hash("[4,26,6]", MPI_COMM_WORLD), one) << precision << " " << force;
    }
}

/// The origin of its file far outside the domain, or the centre in the domain's next period; placed by either
/// point. Numbers of map coordinates keep 1e-9 of a cell.
TEST(MeshBodies, FarFromItsFilesOriginABodyIsWhatItIsNearIt) {
  const auto run = [&](const Vec3& off, const std::string& position) {
    CaseText c = alone(torus_shape);
    c.bodies =
        body_of("body", density,
                position + "\nvelocity = [0.03, 0.01, -0.02]\nangular_velocity = [0.004, 0.003, -0.005]");
    Simulation s(read_with(c, {{"torus.ply", ply_of(torus.shifted(off))}}), MPI_COMM_WORLD);
    EXPECT_EQ(fault_of(s.setup()), "");
    s.run(40);
    Vec3 x = Vec3::Zero(), w = Vec3::Zero();
    if (s.bodies().owned > 0) x = s.bodies().position[0], w = s.bodies().angular_velocity[0];
    for (int d = 0; d < 3; ++d) x[d] = tests::sum_over_ranks(x[d]), w[d] = tests::sum_over_ranks(w[d]);
    return std::pair(x, w);
  };
  const auto near = run(Vec3::Zero(), "position = [2.5, 24.25, 13.75]");
  const std::pair<Vec3, std::string> others[] = {
      {{4.1e5, 5.2e6, -312}, "position = [-409997.5, -5199975.75, 325.75]"},
      {{4.1e5, 5.2e6, -312}, "origin = \"centre\"\nposition = [2.5, 24.25, 13.75]"},
      {{20, 10, 0}, "position = [10.5, 14.25, 13.75]"},  // the centre at 30.5 of 28
      {{-60, 0, 0}, "positions = [[6.5, 24.25, 13.75]]"}};
  for (const auto& [off, position] : others) {
    const auto far = run(off, position);
    EXPECT_LT((far.first - near.first).norm(), 1e-7) << position << ": " << far.first.transpose();
    EXPECT_LT((far.second - near.second).norm(), 1e-9) << position;
  }
}

/// The radius of the ball's corners is such that it has the volume of the sphere.
TEST(MeshBodies, ABallOfTrianglesMovesAsASphere) {
  const double radius = 5, volume = 4. / 3 * std::numbers::pi * radius * radius * radius;
  const rigid::TriangleMesh unit = rigid::testing::icosphere(1, 4);
  const double scale = std::cbrt(volume / unit.mass_properties().volume);
  const auto displacement = [&](const std::string& shape) {
    CaseText c = alone(shape);
    // the default form of the force; both are mapped in every step, for distances do not follow a mesh
    c.rest = "[coupling]\nremap_tolerance = 0\n";
    Simulation s(read_with(c, {{"ball.ply", ply_of(unit)}}, {}), MPI_COMM_SELF);
    const Vec3 start = s.bodies().position[0];
    s.run(400);
    Vec3 moved = s.bodies().position[0] - start;
    for (int d = 0; d < 3; ++d) moved[d] += s.bodies().image[0][d] * double(s.setup().cells[d]);
    return moved;
  };
  const Vec3 sphere = displacement(shape_of("body", "sphere", "radius = 5")),
             ball = displacement(
                 shape_of("body", "mesh", "file = \"ball.ply\"\nscale = " + std::to_string(scale)));
  EXPECT_GT(sphere.norm(), 2);
  EXPECT_LT((ball - sphere).norm(), 2e-3 * sphere.norm()) << ball.transpose() << "; " << sphere.transpose();
}

}  // namespace
}  // namespace silt::coupler::testing
