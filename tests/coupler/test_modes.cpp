// Disturbances of fluid and bodies die away: neither walls nor the coupling in time feed them.
#include <fmt/format.h>
#include <gtest/gtest.h>
#include <algorithm>
#include <array>
#include <cmath>
#include <random>
#include <utility>

#include "lbm/fluid.hpp"
#include "lbm/walls/wall_scheme.hpp"
#include "silt/simulation.hpp"
#include "tests/coupler/single_cells.hpp"
#include "tests/silt/case/case_text.hpp"

namespace silt::coupler::testing {

/// Gives every cell of this rank a velocity of its own, each component below `speed` (cells a step).
inline void stir(FluidFields& fields, double speed) {
  std::mt19937 random(1);
  std::uniform_real_distribution<double> u(-speed, speed);
  for_each_cell(fields, [&](int b, lbm::Int3 x, lbm::Int3) {
    std::array<double, 3> v;
    for (double& component : v) component = u(random);
    for (int i = 0; i < lbm::D3Q19::directions; ++i)
      set_arriving(fields, b, x, i, lbm::equilibrium(i, 0, v.data()));
  });
}

namespace {

using rigid::Vec3;

constexpr int box_edge = 12;   // of the periodic box, cells
constexpr double size = 1e-6;  // of the disturbance, cells a step: bodies cross
                               // no cell, nothing but linear

/// A body at a place and orientation of no symmetry, so many times as heavy as the fluid (0: it is held).
CaseText scene(const std::string& shape, double density, double tau, std::string_view collision) {
  CaseText c;
  c.domain = domain_of({box_edge, box_edge, box_edge}, "\"periodic\"");
  c.fluid = fmt::format("[fluid]\nrelaxation_time = {}\ncollision = \"{}\"\nprecision = \"double\"\n", tau,
                        collision);
  c.shapes = "[[shapes]]\nname = \"body\"\n" + shape;
  c.bodies = body_of(
      "body", density > 0 ? density : 1,
      std::string("position = [6.13, 5.71, 6.37]\norientation = { axis = [3, 1, -2], degrees = 67 }\n") +
          (density > 0 ? "" : "motion = \"fixed\"\n"));
  return c;
}

/// Root mean square of the fluid's velocity about its mean, and the body's difference from it.
double disturbance(const Simulation& s) {
  const FluidFields& fields = s.scene().flow->fields();
  Vec3 sum = Vec3::Zero();
  double square = 0;
  int count = 0;
  for_each_cell(fields, [&](int b, lbm::Int3 x, lbm::Int3) {
    if (!fields.is_fluid(b, x)) return;
    const Vec3 v = velocity(fields, b, x);
    sum += v, square += v.squaredNorm(), ++count;
  });
  const Vec3 mean = sum / count;
  return std::sqrt(std::max(0.0, square / count - mean.squaredNorm())) +
         (s.bodies().velocity[0] - mean).norm();
}

constexpr const char* shapes[] = {"type = \"sphere\"\ndiameter = 6\n",
                                  "type = \"box\"\nedges = [4.7, 4.7, 4.7]\n"};

/// A disturbance after 3000 steps, when what fades quickly has, and after 4000.
std::pair<double, double> disturbances(const std::string& shape, double density, double tau,
                                       std::string_view collision) {
  Simulation s = scene(shape, density, tau, collision).start(MPI_COMM_SELF);
  stir(s.scene().flow->fields(), size);
  s.run(3000);
  const double early = disturbance(s);
  s.run(1000);
  return {early, disturbance(s)};
}

void expect_decay(std::string_view collision, std::initializer_list<double> densities,
                  std::initializer_list<double> taus) {
  constexpr double rounding = 1e-4 * size;  // of the forces' quanta
  for (const char* const shape : shapes)
    for (const double density : densities)
      for (const double tau : taus) {
        const auto [early, late] = disturbances(shape, density, tau, collision);
        EXPECT_LT(late, std::max(early, rounding))
            << collision << ", " << shape << "density " << density << ", tau " << tau;
      }
}
TEST(BodyModes, DisturbancesDieAway) {
  expect_decay("trt", {0.0, 0.02, 0.2, 1.0, 20.0}, {0.502, 0.51, 0.7, 3.0});
}
TEST(BodyModes, DisturbancesDieAwayWithRegularised) {
  expect_decay("regularised", {0.0, 0.2, 5.0}, {0.502, 0.51, 0.7});
}

/// A heavy cube let go while it turns about an axis of no symmetry, its edges across many cells in a turn.
CaseText spinning_cube(double tau, std::string_view wall_scheme) {
  CaseText c;
  c.domain = domain_of({18, 18, 18}, "\"no-slip\"");
  c.fluid = fmt::format("[fluid]\nrelaxation_time = {}\n", tau);
  c.rest = fmt::format("[coupling]\nwall_scheme = \"{}\"\n", wall_scheme);
  c.shapes = shape_of("cube", "box", "edges = [6.2, 6.2, 6.2]");
  c.bodies = body_of("cube", 30,
                     "position = [9.13, 8.71, 9.37]\norientation = { axis = [3, 1, -2], degrees = 67 }\n"
                     "angular_velocity = [0.012, -0.006, 0.009]\n");
  return c;
}

TEST(BodyModes, ASpinningCubeComesToRest) {
  for (const auto wall_scheme : lbm::wall_scheme_names)
    for (const double tau : {0.55, 0.8, 2.0}) {
      SCOPED_TRACE(fmt::format("{}, tau {}", wall_scheme, tau));
      Simulation s = spinning_cube(tau, wall_scheme).start(MPI_COMM_SELF);
      double before = s.bodies().angular_velocity[0].norm(), turned = 0;
      while (before > 1e-5 && s.steps_done() < 5000) {
        for (int t = 0; t < 25; ++t) s.step(), turned += s.bodies().angular_velocity[0].norm();
        const double now = s.bodies().angular_velocity[0].norm();
        ASSERT_LT(now, before) << "after " << s.steps_done() << " steps";
        before = now;
      }
      EXPECT_GT(turned, 0.5);
      EXPECT_LT(s.bodies().velocity[0].norm(),
                2e-4);  // it has no cause to go anywhere
    }
}

struct Scene {
  const char* name;
  CaseText text;
};

CaseText periodic_box(int n) {
  CaseText c;
  c.domain = fmt::format("[domain]\nsize = [{0}, {0}, {0}]\nboundary = \"periodic\"\n", n);
  c.run = "[run]\nsteps = 1\n";
  return c;
}
/// A fixed sphere; the cell centre over its north pole is `gap` outside of it.
CaseText sphere_under_a_cell(int n, double radius, double gap) {
  CaseText c = periodic_box(n);
  c.shapes = fmt::format("[[shapes]]\nname = \"ball\"\ntype = \"sphere\"\nradius = {}\n", radius);
  c.bodies = fmt::format(
      "[[bodies]]\nshape = \"ball\"\ndensity = 1\nmotion = \"fixed\"\nposition = [{0}, {0}, {1:.12g}]\n",
      n / 2 + 0.5, n / 2 + 0.5 - gap);
  return c;
}
/// A fixed cube with a layer of cell centres on, or just off, each side.
CaseText cube(int n, double edge) {
  CaseText c = periodic_box(n);
  c.shapes = fmt::format(
      "[[shapes]]\nname = \"cube\"\ntype = \"box\"\nedges = [{0:.12g}, {0:.12g}, {0:.12g}]\n", edge);
  c.bodies = fmt::format(
      "[[bodies]]\nshape = \"cube\"\ndensity = 1\nmotion = \"fixed\"\nposition = [{0}, {0}, {0}]\n", n / 2);
  return c;
}
/// A tube closed at both ends.
CaseText closed_tube() {
  CaseText c;
  c.domain = domain_of({8, 12, 12}, R"("no-slip")");
  c.rest = "[[walls]]\ntype = \"tube\"\naxis = \"x\"\nradius = 4.3\npoint = [0, 6.13, 5.71]\n";
  c.shapes = c.bodies = "";
  c.run = "[run]\nsteps = 1\n";
  return c;
}

std::vector<Vec3> velocities(const FluidFields& fields) {
  std::vector<Vec3> all;
  for_each_cell(fields, [&](int b, lbm::Int3 x, lbm::Int3) {
    if (fields.is_fluid(b, x)) all.push_back(velocity(fields, b, x));
  });
  return all;
}
/// Does a step, and returns the energy of what turns round in it.
double alternating_energy(Simulation& s) {
  const auto before = velocities(s.scene().flow->fields());
  s.step();
  const auto after = velocities(s.scene().flow->fields());
  double sum = 0;
  for (std::size_t k = 0; k < after.size(); ++k) sum += 0.25 * (after[k] - before[k]).squaredNorm();
  return sum;
}

TEST(WallModes, WhatTurnsRoundEveryStepFades) {
  const Scene scenes[] = {{"cell on a sphere, even box", sphere_under_a_cell(10, 3, 1e-6)},
                          {"cell on a sphere, odd box", sphere_under_a_cell(9, 3, 1e-6)},
                          {"cells on a cube", cube(10, 5 - 2e-6)},
                          {"cube off the cells", cube(10, 4.3)},
                          {"closed tube", closed_tube()}};
  for (const Scene& scene : scenes)
    for (const double tau : {0.51, 0.6, 1.0, 2.0}) {
      CaseText c = scene.text;
      c.fluid = fmt::format("[fluid]\nrelaxation_time = {}\nprecision = \"double\"\n", tau);
      Simulation s = c.start(MPI_COMM_SELF);
      stir(s.scene().flow->fields(), 1e-6);
      const double first = alternating_energy(s);
      s.run(3000);
      const double early = alternating_energy(s);
      s.run(2000);
      EXPECT_LT(alternating_energy(s), std::max(0.9 * early, 1e-12 * first)) << scene.name << ", tau " << tau;
    }
}

/// Alternating part of the force on a body over its mean.
double alternation(Simulation& s) {
  Vec3 f[3];
  for (Vec3& force : f) s.step(), force = s.last_loads()[0].force;
  return (f[0] - 2 * f[1] + f[2]).norm() / (f[0] + 2 * f[1] + f[2]).norm();
}

TEST(WallModes, ForceDoesNotAlternateWhereACellLiesOnTheSurface) {
  for (const double gap : {1e-6, 1e-4, 1e-3, 1e-2}) {
    CaseText c = sphere_under_a_cell(11, 3, gap);
    c.fluid = "[fluid]\nrelaxation_time = 1\nprecision = \"double\"\nbody_force = [1e-6, 3e-7, 7e-7]\n";
    Simulation s = c.start(MPI_COMM_SELF);
    s.run(4000);
    EXPECT_LT(alternation(s), 1e-5) << gap;
  }
}

/// Spheres a fraction of a cell apart: pockets of one cell, links shut on both sides.
TEST(WallModes, FluidInSingleCellGapsComesToRest) {
  for (const double gap : {0.2, 0.4, 0.7, 1.0})
    for (const double tau : {0.51, 0.6, 1.0, 2.0}) {
      CaseText c = periodic_box(7);
      c.fluid = fmt::format("[fluid]\nrelaxation_time = {}\n", tau);
      c.shapes = fmt::format("[[shapes]]\nname = \"ball\"\ntype = \"sphere\"\ndiameter = {}\n", 7 - gap);
      c.bodies = body_of("ball", 1, "motion = \"fixed\"\nposition = [3.63, 3.31, 3.47]");
      Simulation s = c.start(MPI_COMM_SELF);
      stir(s.scene().flow->fields(), 0.02);
      const auto moves = [&] { return s.checked_totals().max_speed >= 1e-6; };
      while (s.steps_done() < 20000 && moves()) s.run(500);
      s.run(500);
      EXPECT_FALSE(moves()) << "gap " << gap << ", tau " << tau;
    }
}

/// Force over velocity of a dense array of spheres, most links of which are narrow.
double resistance(const char* scheme, double tau) {
  CaseText c = periodic_box(8);
  const double nu = (tau - 0.5) / 3;
  c.fluid = fmt::format("[fluid]\nrelaxation_time = {}\nprecision = \"double\"\nbody_force = [{}, 0, 0]\n",
                        tau, 1e-6 * nu);
  c.shapes = shape_of("ball", "sphere", "diameter = 7.1");
  c.bodies = body_of("ball", 1, "motion = \"fixed\"\nposition = [4.13, 4.31, 3.87]");
  Simulation s = c.start(MPI_COMM_SELF, {std::string("coupling.wall_scheme=") + scheme});
  s.run(int(400 / nu));
  const FlowTotals t = s.checked_totals();
  return 1 / (t.momentum[0] / (1e-6 * nu) + 0.5 * double(t.fluid_cells)) / nu;
}

TEST(WallModes, DragOfADenseArrayDoesNotDependOnViscosity) {
  for (const char* scheme : {"cli", "parabolic"}) {
    const double at_one = resistance(scheme, 1);
    for (const double tau : {0.55, 2.0})
      EXPECT_NEAR(resistance(scheme, tau) / at_one, 1, 1e-3) << scheme << tau;
  }
}

}  // namespace

}  // namespace silt::coupler::testing
