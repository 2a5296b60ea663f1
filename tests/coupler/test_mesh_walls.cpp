// Walls of triangles in a fluid: against the same walls given as formulas.
#include <fmt/format.h>
#include <gtest/gtest.h>
#include <mpi.h>

#include <cmath>
#include <numbers>

#include "lbm/cut_links.hpp"
#include "tests/coupler/case/mesh_case.hpp"
#include "tests/coupler/case/pipe_case.hpp"
#include "tests/coupler/coupled_scenes.hpp"
#include "tests/coupler/single_cells.hpp"

namespace silt::coupler::testing {
namespace {

using rigid::Vec3;

/// F / (6 pi mu a U) of the array.
double coefficient(Simulation& s, double wall_force) {
  const FlowTotals t = s.look_at_flow();
  const double a = array_diameter / 2, viscosity = (1 - 0.5) / 3;
  const double u = (t.momentum[0] + 0.5 * array_force * double(t.fluid_cells)) / std::pow(array_edge, 3);
  return (wall_force + array_force * 4 * M_PI / 3 * a * a * a) / (6 * M_PI * viscosity * a * u);
}

/// Of the sphere of 5120 triangles with the sphere's volume.
TEST(MeshWalls, DragOfASphereOfTrianglesIsThatOfTheSphere) {
  constexpr int steps = 1500;
  const rigid::TriangleMesh unit = rigid::testing::icosphere(1, 4);
  const double volume = std::numbers::pi / 6 * std::pow(array_diameter, 3);
  const auto ball = rigid::testing::scaled(unit, std::cbrt(volume / unit.mass_properties().volume));
  EXPECT_NEAR(ball.mass_properties().volume, volume, 1e-9 * volume);
  double worst = 0;
  for (const char* at : {"[8.13,8.31,7.87]", "[8.31,8.13,8.47]", "[8.2,8.4,8.1]", "[8.05,8.15,8.35]",
                         "[8.42,7.71,8.27]", "[7.64,8.44,7.93]", "[8,8,8]", "[15.9,0.2,8.6]"}) {
    Simulation sphere = sphere_array().start(MPI_COMM_SELF, {std::string("bodies[0].position=") + at});
    CaseText text =
        mesh_case("ball.ply", std::string("solid = \"inside\"\naxis_angle = { axis = [1, 2, 3], degrees = "
                                          "20 }\nposition = ") +
                                  at);
    text.domain = sphere_array().domain, text.fluid = sphere_array().fluid;
    Simulation mesh(read_with(text, {{"ball.ply", ply_of(ball)}}), MPI_COMM_SELF);
    sphere.run(steps), mesh.run(steps);
    const double exact = coefficient(sphere, sphere.last_loads()[0].force[0]);
    const double found =
        coefficient(mesh, lbm::link_quantum * double(mesh.scene().flow->account().wall_load(0)[0]));
    worst = std::max(worst, std::fabs(found / exact - 1));
    EXPECT_NEAR(found / exact, 1, 1e-3) << at;
  }
  printf("drag of a sphere of 5120 triangles: at most %.4f %% from that of the sphere\n", 100 * worst);
}

/// Largest difference of the velocities over the largest velocity, where both have fluid.
double difference(const Simulation& a, const Simulation& b) {
  double apart = 0, largest = 0;
  const FluidFields &f = a.scene().flow->fields(), &g = b.scene().flow->fields();
  for_each_cell(f, [&](int block, lbm::Int3 cell, lbm::Int3) {
    if (!f.is_fluid(block, cell) || !g.is_fluid(block, cell)) return;
    const Vec3 one = velocity(f, block, cell), other = velocity(g, block, cell);
    apart = std::max(apart, (one - other).norm()), largest = std::max(largest, one.norm());
  });
  return apart / largest;
}

/// Along x, off the lattice and rolled about its axis, of 200 facets.
TEST(MeshWalls, FlowInAPipeOfTrianglesIsThatInATube) {
  constexpr double radius = 10.6, force = 0.05 * 4 * 0.1 / (radius * radius);
  constexpr int steps = 2500;
  const CaseText round = pipe(radius, "", force, steps);
  const int n = 2 * int(std::ceil(radius)) + 2;
  CaseText facets =
      mesh_case("pipe.ply", fmt::format("solid = \"outside\"\nposition = [2, {}, {}]\naxis = [1, 0, 0]",
                                        n / 2 + 0.13, n / 2 - 0.29));
  facets.domain = round.domain, facets.fluid = round.fluid, facets.run = round.run;
  Simulation tube = round.start(MPI_COMM_SELF);
  Simulation mesh(read_with(facets, {{"pipe.ply", ply_of(rigid::testing::prism_mesh(radius, 20, 200))}}),
                  MPI_COMM_SELF);
  tube.run(steps), mesh.run(steps);
  const double apart = difference(tube, mesh);
  printf("flow in a pipe of 200 facets: %.4f %% from that in a tube\n", 100 * apart);
  EXPECT_LT(apart, 2e-3);
}

/// Tilted in a closed box, both turning about their axis: cells change sides as the facets pass.
TEST(MeshWalls, ATiltedPipeThatTurnsStirsAsATubeDoes) {
  constexpr double radius = 8.3;
  constexpr int steps = 1200;
  CaseText c;
  c.domain = domain_of({24, 24, 24}, "\"no-slip\"");
  c.fluid = "[fluid]\nrelaxation_time = 0.8\nprecision = \"double\"\n";
  c.shapes = c.bodies = "";
  const std::string axis = "[0.3, 0.5, 1]", point = "[12.2, 11.7, 12]";
  c.rest = "[[walls]]\ntype = \"tube\"\nangular_velocity = 0.002\nradius = " + fmt::format("{}", radius) +
           "\naxis = " + axis + "\npoint = " + point + "\n";
  CaseText facets = mesh_case("pipe.ply", "solid = \"outside\"\naxis = " + axis + "\nposition = " + point +
                                              "\nmotion = { angular_velocity = 0.002, axis = " + axis + " }");
  facets.domain = c.domain, facets.fluid = c.fluid;
  Simulation tube = c.start(MPI_COMM_SELF);
  Simulation mesh(read_with(facets, {{"pipe.ply", ply_of(rigid::testing::prism_mesh(radius, 40, 200))}}),
                  MPI_COMM_SELF);
  tube.run(steps), mesh.run(steps);
  const auto torque = [](const Simulation& s) {
    const auto load = s.scene().flow->account().wall_load(0);
    return Vec3(double(load[3]), double(load[4]), double(load[5]));
  };
  const double apart = difference(tube, mesh),
               torques = (torque(mesh) - torque(tube)).norm() / torque(tube).norm();
  printf("tilted pipe of 200 facets that turns: flow %.4f %%, torque %.4f %% from those of a tube\n",
         100 * apart, 100 * torques);
  EXPECT_LT(apart, 2e-3);
}

/// A plate of 1.2 cells, and two plates 0.7 cells apart; one of 3 cells is fine.
TEST(MeshWalls, ThinPartsAndGapsAreWarnedOf) {
  const auto warnings = [](const rigid::TriangleMesh& mesh) {
    std::string all;
    for (const Diagnostic& d : judgement(read_with(
             mesh_case("a.ply", "solid = \"inside\"\nposition = [16, 16, 16]"), {{"a.ply", ply_of(mesh)}})))
      all += d.text + '\n';
    return all;
  };
  using rigid::testing::cuboid_mesh;
  EXPECT_EQ(warnings(cuboid_mesh({-8, -8, -1.5}, {8, 8, 1.5})), "");
  EXPECT_NE(warnings(cuboid_mesh({-8, -8, -0.6}, {8, 8, 0.6})).find("a thickness of 1.2 at ["),
            std::string::npos);
  const rigid::TriangleMesh low = cuboid_mesh({-8, -8, -4}, {8, 8, 0}), high = low.shifted({0, 0, 4.7});
  std::vector<Vec3> corners(low.vertices().begin(), low.vertices().end());
  corners.insert(corners.end(), high.vertices().begin(), high.vertices().end());
  rigid::testing::Triangles triangles(low.triangles().begin(), low.triangles().end());
  for (auto t : high.triangles()) {
    for (auto& corner : t) corner += 8;
    triangles.push_back(t);
  }
  const std::string found = warnings({corners, triangles});
  EXPECT_NE(found.find("a gap of 0.7 at ["), std::string::npos) << found;
  EXPECT_NE(found.find("thinner than a cell"), std::string::npos) << found;
}

}  // namespace
}  // namespace silt::coupler::testing
