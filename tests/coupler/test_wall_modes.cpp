// What turns round in every step must fade, and fluid between surfaces come to rest: cut links at their
// worst.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "coupler/simulation.hpp"
#include "tests/coupler/case/case_text.hpp"
#include "tests/coupler/stirred_fluid.hpp"

namespace silt::coupler::testing {
namespace {

using rigid::Vec3;

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
  c.domain = "[domain]\nsize = [8, 12, 12]\nboundary = \"no-slip\"\n";
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
/// Of what turns round between this step and the next, which is done.
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
      c.bodies =
          "[[bodies]]\nshape = \"ball\"\ndensity = 1\nmotion = \"fixed\"\nposition = [3.63, 3.31, 3.47]\n";
      Simulation s = c.start(MPI_COMM_SELF);
      stir(s.scene().flow->fields(), 0.02);
      s.run(20000);
      EXPECT_LT(s.look_at_flow().max_speed, 1e-6) << "gap " << gap << ", tau " << tau;
    }
}

/// Force over velocity of a dense array of spheres, most links of which are narrow.
double resistance(const char* scheme, double tau) {
  CaseText c = periodic_box(8);
  const double nu = (tau - 0.5) / 3;
  c.fluid = fmt::format("[fluid]\nrelaxation_time = {}\nprecision = \"double\"\nbody_force = [{}, 0, 0]\n",
                        tau, 1e-6 * nu);
  c.shapes = "[[shapes]]\nname = \"ball\"\ntype = \"sphere\"\ndiameter = 7.1\n";
  c.bodies = "[[bodies]]\nshape = \"ball\"\ndensity = 1\nmotion = \"fixed\"\nposition = [4.13, 4.31, 3.87]\n";
  Simulation s = c.start(MPI_COMM_SELF, {std::string("coupling.wall_scheme=") + scheme});
  s.run(int(400 / nu));
  const FlowTotals t = s.look_at_flow();
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
