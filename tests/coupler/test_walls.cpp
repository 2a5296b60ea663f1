// Bodies and walls in a fluid against theory: drag, buoyancy and rest, flow in tubes, and walls and bodies of
// triangles against the same given as formulas.
#include <fmt/format.h>
#include <gtest/gtest.h>
#include <mpi.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "coupler/flow.hpp"
#include "lbm/walls/cut_links.hpp"
#include "lbm/walls/wall_scheme.hpp"
#include "silt/case/case.hpp"
#include "silt/case/case_check.hpp"
#include "silt/case/case_error.hpp"
#include "silt/case/quantity_spec.hpp"
#include "silt/placement/given_bodies.hpp"
#include "silt/simulation.hpp"
#include "tests/coupler/single_cells.hpp"
#include "tests/errors.hpp"
#include "tests/silt/case/mesh_case.hpp"
#include "tests/silt/case/pipe_case.hpp"
#include "tests/silt/coupled_scenes.hpp"

namespace silt::coupler::testing {
namespace {

using rigid::Vec3;
using std::numbers::pi;

/// F / (6 pi mu a U) of the array, F: wall force + body force on the sphere's volume, U: mean over the whole
/// cube.
double drag_coefficient(const std::string& scheme, double tau, int steps) {
  Simulation s = sphere_array().start(
      MPI_COMM_SELF, {fmt::format("fluid.relaxation_time={}", tau), "bodies[0].position=[8.13,8.31,7.87]",
                      "coupling.wall_scheme=" + scheme});
  s.run(steps);
  double force = 0;
  for (const auto& load : s.last_loads()) force += load.force[0];
  const FlowTotals t = s.checked_totals();
  const double a = array_diameter / 2, g = array_force, viscosity = (tau - 0.5) / 3;
  const double u = (t.momentum[0] + 0.5 * g * double(t.fluid_cells)) / std::pow(array_edge, 3);
  return (force + g * 4 * M_PI / 3 * a * a * a) / (6 * M_PI * viscosity * a * u);
}

// The drag does not depend on the relaxation time, with Lambda given; under multireflection as long as its
// share is whole.
TEST(CoupledStep, DragDoesNotDependOnViscosity) {
  const auto expect_same = [](const std::string& scheme, double low, int steps) {
    const double one = drag_coefficient(scheme, 1, 2500);
    EXPECT_NEAR(drag_coefficient(scheme, low, steps) / one, 1, 1e-4) << scheme;
    EXPECT_NEAR(drag_coefficient(scheme, 1.5, 1500) / one, 1, 1e-4) << scheme;
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
    const double speed = s.checked_totals().max_speed;
    double body = 0;
    for (std::size_t row = 0; row < s.bodies().owned; ++row)
      body = std::max(body, s.bodies().velocity[row].norm() + 4 * s.bodies().angular_velocity[row].norm());
    printf("heap at rest, %s: fastest fluid %.2g, fastest surface %.2g\n", name.c_str(), speed, body);
    EXPECT_LT(speed, 1e-3) << name;
  }
}

/// Until the flow is steady: exp(-5.78 nu t / R^2) is below 1e-7.
int long_enough(double radius) {
  return int(radius * radius / 0.1 * 3);
}

/// Along the body force in the tube of a case g (R^2 - r^2) / (4 nu) along the axis, and its rigid motion.
rigid::Vec3 exact_velocity(const Case& setup, const rigid::Vec3& x) {
  const rigid::TubeWallSpec& wall = *setup.walls[0].tube();
  const double radius = wall.tube.radius;
  const rigid::Vec3 from = x - wall.point, arm = from - wall.axis.dot(from) * wall.axis;
  const double flow = setup.fluid->body_force.dot(wall.axis) * (radius * radius - arm.squaredNorm()) /
                      (4 * setup.fluid->kinematic_viscosity);
  return flow * wall.axis + wall.angular_velocity * wall.axis.cross(arm);
}

/// Relative L2 error against the exact flow of the mean velocity over two steps. (A sudden start leaves a
/// staggered momentum, u_y ~ (-1)^(y + t), that no collision damps; it changes its sign from step to step.)
double error_of(Simulation& simulation) {
  const FluidFields& fields = simulation.scene().flow->fields();
  std::vector<rigid::Vec3> before;
  for_each_cell(fields,
                [&](int b, lbm::Int3 cell, lbm::Int3) { before.push_back(velocity(fields, b, cell)); });
  simulation.step();
  double sums[2] = {};
  auto then = before.begin();
  for_each_cell(fields, [&](int b, lbm::Int3 cell, lbm::Int3 g) {
    const rigid::Vec3 mean = 0.5 * (*then++ + velocity(fields, b, cell));
    if (!fields.is_fluid(b, cell)) return;
    const rigid::Vec3 v = exact_velocity(simulation.setup(), {g.x + 0.5, g.y + 0.5, g.z + 0.5});
    sums[0] += (mean - v).squaredNorm(), sums[1] += v.squaredNorm();
  });
  return std::sqrt(sums[0] / sums[1]);
}

/// Order of convergence between radii: the slope of the regression of log error on log radius.
double order(const std::vector<double>& radii, const std::vector<double>& errors) {
  double x = 0, y = 0, xx = 0, xy = 0;
  const double n = double(radii.size());
  for (std::size_t k = 0; k < radii.size(); ++k) {
    const double a = std::log(radii[k]), b = std::log(errors[k]);
    x += a, y += b, xx += a * a, xy += a * b;
  }
  return -(n * xy - x * y) / (n * xx - x * x);
}

/// Returns the load of the fluid on the tube, on one rank.
BodyLoad load_of_fluid(const Simulation& simulation) {
  const auto share = simulation.scene().flow->account().wall_load(0);
  BodyLoad load;
  for (int d = 0; d < 3; ++d) {
    load.force[d] = lbm::link_quantum * double(share[d]);
    load.torque[d] = lbm::link_quantum * double(share[3 + d]);
  }
  return load;
}

constexpr double radii[] = {5.3, 7.45, 10.6, 14.9};

TEST(Tube, ItsPointMayBeFarAlongItsAxis) {
  const CaseText text = pipe(7.45, "angular_velocity = 0.002", 1e-5, 1);
  Simulation near = text.start(MPI_COMM_SELF),
             far = text.start(MPI_COMM_SELF, {"walls[0].point=[-1e8, 9.13, 8.71]"});
  near.run(20), far.run(20);
  EXPECT_EQ(near.hash(), far.hash());
}

TEST(Tube, PoiseuilleIsOfSecondOrder) {
  std::vector<double> errors;
  for (const double radius : radii) {
    const double force = 0.05 * 4 * 0.1 / (radius * radius);
    Simulation simulation = pipe(radius, "", force, 1).start(MPI_COMM_SELF);
    simulation.run(long_enough(radius));
    errors.push_back(error_of(simulation));
    // what drives the fluid ends up on the wall
    const FlowTotals totals = simulation.checked_totals();
    EXPECT_NEAR(load_of_fluid(simulation).force[0], force * double(totals.fluid_cells),
                1e-5 * force * double(totals.fluid_cells));
    EXPECT_NEAR(totals.mass_deviation, 0, 1e-8 * double(totals.fluid_cells));
    // second order, small: only rows of one and two cells between the walls do not have the parabola
    EXPECT_LT(errors.back(), 0.04 / (radius * radius)) << radius;
  }
  EXPECT_GT(order({std::begin(radii), std::end(radii)}, errors), 1.7)
      << errors[0] << ' ' << errors[1] << ' ' << errors[2] << ' ' << errors[3];
}

/// The fluid in a tube that turns comes to move with it as if it were rigid: without shear the
/// links are exact, wherever they cut. Then nothing acts on the wall.
TEST(Tube, FluidMovesRigidlyWithTheTube) {
  for (const double radius : radii) {
    const std::string motion = fmt::format("angular_velocity = {}", 0.02 / radius);
    Simulation simulation = pipe(radius, motion, 0, 1).start(MPI_COMM_SELF);
    simulation.run(long_enough(radius));
    const BodyLoad one = load_of_fluid(simulation);
    EXPECT_LT(error_of(simulation), 1e-3) << radius;
    const BodyLoad next = load_of_fluid(simulation);
    const double scale = 4 * pi * 0.1 * 0.02 * radius * 4;  // of the torque while it spins up
    EXPECT_LT(0.5 * std::abs(one.torque[0] + next.torque[0]), 2e-3 * scale) << radius;
    EXPECT_LT(0.5 * std::abs(one.force[0] + next.force[0]), 1e-6) << radius;
  }
}

/// The torque that spins the fluid up is what its angular momentum gains.
TEST(Tube, TorqueIsTheGainOfAngularMomentum) {
  const double radius = 10.6, omega = 0.02 / radius;
  Simulation simulation =
      pipe(radius, fmt::format("angular_velocity = {}", omega), 0, 1).start(MPI_COMM_SELF);
  double given = 0;
  for (int i = 0; i < long_enough(radius); ++i) {
    simulation.step();
    given -= load_of_fluid(simulation).torque[0];
  }
  const double gained = 0.5 * pi * std::pow(radius, 4) * 4 * omega;
  EXPECT_NEAR(given, gained, 0.02 * gained);
}

/// F / (6 pi mu a U) of the array.
double coefficient(Simulation& s, double wall_force) {
  const FlowTotals t = s.checked_totals();
  const double a = array_diameter / 2, viscosity = (1 - 0.5) / 3;
  const double u = (t.momentum[0] + 0.5 * array_force * double(t.fluid_cells)) / std::pow(array_edge, 3);
  return (wall_force + array_force * 4 * M_PI / 3 * a * a * a) / (6 * M_PI * viscosity * a * u);
}

/// The sphere of 5120 triangles has the sphere's volume.
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
        mesh_case("ball.ply", std::string("solid = \"inside\"\norientation = { axis = [1, 2, 3], degrees = "
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

/// The radius of the ball's corners is such that it has the volume of the sphere.
TEST(MeshBodies, ABallOfTrianglesMovesAsASphere) {
  const double radius = 5, volume = 4. / 3 * pi * radius * radius * radius;
  const rigid::TriangleMesh unit = rigid::testing::icosphere(1, 4);
  const double scale = std::cbrt(volume / unit.mass_properties().volume);
  const auto displacement = [&](const std::string& shape) {
    CaseText c;
    c.domain = domain_of({28, 26, 24});
    c.fluid = "[fluid]\nrelaxation_time = 0.8\nprecision = \"double\"\n";
    // both are mapped in every step, for distances do not follow a mesh
    c.rest = "[coupling]\nremap_tolerance = 0\n";
    c.shapes = shape;
    c.bodies =
        body_of("body", 2,
                "orientation = [0.8, 0.3, -0.4, 0.5]\nposition = [2.3, 24.1, 13.7]\nvelocity = [0.03, 0.01, "
                "-0.02]\nangular_velocity = [0.004, 0.003, -0.005]");
    Simulation s(read_with(c, {{"ball.ply", ply_of(unit)}}), MPI_COMM_SELF);
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

/// A turned ball of triangles may touch a side: the corners of its turned box, which are beyond, are not its
/// own.
TEST(MeshBodies, ATurnedBallMayStartBesideASide) {
  CaseText c;
  c.domain = domain_of({28, 26, 24}, "\"no-slip\"");
  c.shapes = shape_of("body", "mesh", "file = \"ball.ply\"\nscale = 5");
  const auto start_at = [&](double z) {
    c.bodies = body_of(
        "body", 2,
        fmt::format("orientation = {{ axis = [1, 1, 0], degrees = 45 }}\nposition = [14, 13, {}]", z));
    const Case scene = read_with(c, {{"ball.ply", ply_of(rigid::testing::icosphere(1, 4))}});
    require_sound_start(scene, coupler::make_domain(scene, 1), MPI_COMM_SELF);
  };
  start_at(5.01);
  EXPECT_THROW(start_at(4.9), CaseError);
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
  EXPECT_GT(largest, 0) << "no cell is fluid in both, or nothing flows there";
  return apart / largest;
}

/// Along x, off the lattice and rolled about its axis, of 200 facets.
TEST(MeshWalls, FlowInAPipeOfTrianglesIsThatInATube) {
  constexpr double radius = 10.6, force = 0.05 * 4 * 0.1 / (radius * radius);
  constexpr int steps = 2500;
  const CaseText round = pipe(radius, "", force, steps);
  const int n = 2 * int(std::ceil(radius)) + 2;
  CaseText facets = mesh_case(
      "pipe.ply", fmt::format("solid = \"outside\"\nposition = [2, {}, {}]\norientation = [1, 0, 0]",
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
  CaseText facets =
      mesh_case("pipe.ply", "solid = \"outside\"\norientation = " + axis + "\nposition = " + point +
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
  EXPECT_TEXT(warnings(cuboid_mesh({-8, -8, -0.6}, {8, 8, 0.6})), "a thickness of 1.2 at [");
  const rigid::TriangleMesh low = cuboid_mesh({-8, -8, -4}, {8, 8, 0}), high = low.shifted({0, 0, 4.7});
  std::vector<Vec3> corners(low.vertices().begin(), low.vertices().end());
  corners.insert(corners.end(), high.vertices().begin(), high.vertices().end());
  rigid::testing::Triangles triangles(low.triangles().begin(), low.triangles().end());
  for (auto t : high.triangles()) {
    for (auto& corner : t) corner += 8;
    triangles.push_back(t);
  }
  const std::string found = warnings({corners, triangles});
  EXPECT_TEXT(found, "a gap of 0.7 at [");
  EXPECT_TEXT(found, "thinner than a cell");
}

}  // namespace
}  // namespace silt::coupler::testing
