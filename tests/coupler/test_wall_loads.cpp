// What fluid and bodies do to walls, rotors of triangles among them, and where balls come to rest in a tube.
#include <fmt/format.h>
#include <gtest/gtest.h>
#include <mpi.h>

#include <algorithm>
#include <numbers>

#include "silt/simulation.hpp"
#include "tests/coupler/rotor_case.hpp"
#include "tests/silt/case/mesh_case.hpp"
#include "tests/silt/case/pipe_case.hpp"
#include "tests/world.hpp"

namespace silt::coupler::testing {
namespace {

using std::numbers::pi;

/// A ball dropped into a tube full of fluid ends at its lowest line.
TEST(Tube, BallSettlesOnTheLowestLine) {
  CaseText c = pipe(11, "", 0, 1);
  c.fluid = "[fluid]\nrelaxation_time = 1\n";
  c.domain.replace(c.domain.find("size = [4"), 9, "size = [16");
  c.rest += "[gravity]\nacceleration = [0, 0, -2e-3]\n";
  c.shapes = CaseText().shapes;
  c.bodies = body_of("ball", 3, "position = [8, 14, 10]");
  Simulation simulation = c.start(MPI_COMM_WORLD, {"domain.blocks=[8, 12, 12]"});
  simulation.run(2500);
  const auto& bodies = simulation.bodies();
  for (std::size_t row = 0; row < bodies.owned; ++row) {
    EXPECT_NEAR(bodies.position[row][1], 12.13, 0.3);
    EXPECT_NEAR(bodies.position[row][2], 11.71 - 7, 0.05);
  }
  EXPECT_LT(simulation.counters().penetration, 0.02);
}

double quantity_of(const CaseText& text) {
  return text.values(MPI_COMM_WORLD).front();
}

CaseText couette(const std::string& quantity) {
  CaseText c;
  c.domain =
      "[domain]\nsize = [8, 8, 16]\nblocks = [4, 4, 8]\nboundary = { x = \"periodic\", y = \"periodic\", z = "
      "[\"no-slip\", { type = \"moving\", velocity = [0.03, 0.04, 0] }] }\n";
  c.fluid = "[fluid]\nrelaxation_time = 0.8\nprecision = \"double\"\n";
  c.shapes = c.bodies = "";
  c.run = "[run]\nsteps = 6000\n[[quantities]]\nname = \"q\"\n" + quantity + "\ntime = 5999\n";
  return c;
}

/// mu U / H on the side that rests, and against the motion on the one that moves.
TEST(WallQuantities, StressOfPlaneCouetteFlow) {
  const double stress = 0.1 / 16;
  const std::string type = "type = \"wall-stress\"\n";
  EXPECT_NEAR(quantity_of(couette(type + "side = \"z-low\"\naxis = \"x\"")), 0.03 * stress, 1e-9 * stress);
  EXPECT_NEAR(quantity_of(couette(type + "side = \"z-high\"\naxis = \"y\"")), -0.04 * stress, 1e-9 * stress);
  EXPECT_NEAR(quantity_of(couette(type + "side = \"z-high\"\naxis = \"z\"")), 0, 1e-3 * stress);
  EXPECT_NEAR(quantity_of(couette("type = \"relative-viscosity\"\naxis = \"z\"")), 1, 1e-7);
}

/// At rest in a closed box the pressure balances the body force: floor and ceiling bear half of it each, and
/// the other sides nothing of it, edges included, whatever the direction.
TEST(WallQuantities, SidesBearThePressureOfTheirOwnFace) {
  for (int axis = 0; axis < 3; ++axis) {
    CaseText c;
    c.domain = domain_of({8, 10, 12}, "\"no-slip\"");  // odd numbers of cells keep a wave of period 2
    c.fluid = fmt::format("[fluid]\nrelaxation_time = 1\nprecision = \"double\"\nbody_force = [{}, {}, {}]\n",
                          axis == 0 ? 1e-5 : 0, axis == 1 ? 1e-5 : 0, axis == 2 ? 1e-5 : 0);
    c.shapes = c.bodies = "";
    c.run = "[run]\nsteps = 4000\n";
    for (int side = 0; side < 6; ++side)
      c.run += fmt::format(
          "[[quantities]]\nname = \"{0}\"\ntype = \"fluid-force\"\nside = \"{0}\"\naxis = \"{1}\"\n",
          side_names[Side(side)], "xyz"[axis]);
    const std::vector<double> force = c.values(MPI_COMM_WORLD);
    const double weight = 1e-5 * 8 * 10 * 12;
    for (int side = 0; side < 6; ++side)
      EXPECT_NEAR(force[side], side / 2 == axis ? weight / 2 : 0, 1e-6 * weight)
          << axis << side_names[Side(side)];
  }
}

/// A ball of twice the fluid's density on the floor presses with its weight less its buoyancy.
TEST(WallQuantities, StressOfABallOnTheFloor) {
  CaseText c = couette("type = \"wall-stress\"\nside = \"z-low\"\naxis = \"z\"");
  c.domain =
      "[domain]\nsize = [16, 16, 16]\nblocks = [8, 8, 8]\nboundary = { x = \"periodic\", y = \"periodic\", z "
      "= [\"no-slip\", \"no-slip\"] }\n";
  c.fluid = "[fluid]\nrelaxation_time = 1\n";
  c.rest = "[gravity]\nacceleration = [0, 0, -1e-3]\n";
  c.shapes = CaseText().shapes;
  c.bodies = body_of("ball", 2, "position = [8, 8, 4.1]");
  const double weight = 4. / 3 * pi * 64 * 1e-3;
  c.run =
      "[run]\nsteps = 1500\n[[quantities]]\nname = \"q\"\ntype = \"wall-stress\"\nside = \"z-low\"\naxis = "
      "\"z\"\ntime = 1400\n";
  EXPECT_NEAR(quantity_of(c), -weight / 256, 2e-2 * weight / 256);
}

TEST(WallQuantities, DistanceFromTheAxis) {
  CaseText c = pipe(11, "", 0, 1);
  c.fluid = "";
  c.shapes = CaseText().shapes;
  c.bodies = body_of("ball", 3, "position = [2, 15.13, 15.71]");
  c.domain.replace(c.domain.find("size = [4"), 9, "size = [16");
  c.run = "[run]\nsteps = 1\n[[quantities]]\nname = \"q\"\ntype = \"axis-distance\"\n";
  EXPECT_NEAR(quantity_of(c), 5, 1e-12);
}

/// The power of a rotor is the torque of the fluid about its point times its speed: of one that turns about
/// itself, and of a vane far from the point that it turns about.
TEST(MeshWalls, PowerIsTorqueTimesAngularVelocity) {
  for (const auto& [speed, about, steps, from] : {std::tuple(0.004, "axis = [0.2, 0.1, 1]", 200, 100),
                                                  {1e-5, "axis = \"z\", point = [4000, 16, 16]", 60, 0}}) {
    CaseText text = rotor_case(fmt::format("{{ angular_velocity = {}, {} }}", speed, about));
    text.run = fmt::format("[run]\nsteps = {}\n", steps);
    for (const char* what : {"torque", "power"})
      text.run +=
          fmt::format("[[quantities]]\nname = \"{0}\"\ntype = \"wall-{0}\"\ntime = {1}\n", what, from);
    Simulation simulation(read_with(text, gear()), MPI_COMM_WORLD);
    const auto values = values_of(simulation);
    EXPECT_LT(values[0], 0) << about << ": the fluid holds it back";
    EXPECT_NEAR(values[1], -speed * values[0], 1e-9 * values[1]) << about;
  }
}

/// Whatever cells it covers and leaves: their momentum, 0.06 a cell, would be felt in jolts.
TEST(MeshWalls, AWallThatMovesWithTheFluidFeelsNothing) {
  CaseText text = mesh_case("gear.ply",
                            "scale = 9\nsolid = \"inside\"\nposition = [15.7, 16.2, 16.4]\n"
                            "motion = { velocity = [0.05, 0.03, -0.02] }");
  text.domain = domain_of({32, 32, 32});
  text.fluid =
      "[fluid]\nrelaxation_time = 0.7\nprecision = \"double\"\n"
      "initial = { type = \"uniform\", velocity = [0.05, 0.03, -0.02] }\n";
  text.rest += "[coupling]\nforce = \"exact\"\n";
  Simulation simulation(read_with(text, gear()), MPI_COMM_WORLD);
  double largest = 0;
  for (int step = 0; step < 100; ++step) {
    simulation.step();
    for (const std::int64_t quanta : load_on_wall(simulation))
      largest = std::max(largest, std::abs(double(quanta)) * lbm::link_quantum);
  }
  EXPECT_GT(tests::sum_over_ranks(double(simulation.counters().uncovered)), 100);
  EXPECT_LT(largest, 1e-9);
}

/// Values of the quantities of a wall after some steps, and what of the fluid there is.
struct Told {
  double force_y = 0, force_z = 0, torque = 0;
  std::uint64_t fluid_cells = 0;
  rigid::Vec3 momentum;
};

/// A gear at rest in a stream, its file `off` from the origin; torques are about the x axis through `point`.
Told stream_past_gear(const rigid::Vec3& off, const std::string& point) {
  CaseText text =
      mesh_case("gear.ply", fmt::format("scale = 9\nsolid = \"inside\"\nposition = [{:.17g}, {:.17g}, "
                                        "{:.17g}]\nmotion = {{ axis = \"x\"{} }}",
                                        15.7 - 9 * off[0], 16.2 - 9 * off[1], 16.4 - 9 * off[2], point));
  text.domain = domain_of({32, 32, 32});
  text.fluid = "[fluid]\nrelaxation_time = 0.7\nprecision = \"double\"\nbody_force = [0, 1e-5, 2e-5]\n";
  text.run = "[run]\nsteps = 200\n";
  for (const char* quantity :
       {"\"fy\"\ntype = \"wall-force\"\naxis = \"y\"", "\"fz\"\ntype = \"wall-force\"\naxis = \"z\"",
        "\"t\"\ntype = \"wall-torque\""})
    text.run += std::string("[[quantities]]\ntime = 100\nname = ") + quantity + "\n";
  const rigid::TriangleMesh mesh = rigid::testing::gear_mesh(7, 3).shifted(off);
  const Case scene = read_with(text, {{"gear.ply", ply_of(mesh)}}, {"domain.blocks=[16, 16, 16]"});
  Simulation simulation(scene, MPI_COMM_WORLD);
  const auto values = values_of(simulation);
  const FlowTotals totals = simulation.checked_totals();
  return {values[0], values[1], values[2], totals.fluid_cells, rigid::Vec3(totals.momentum.data())};
}

/// The file of the wall is in map coordinates, whose numbers keep 1e-9 of a cell; the torque about the same
/// point, and by r x F about the file's origin.
TEST(MeshWalls, FarFromItsFilesOriginAWallIsWhatItIsNearIt) {
  const rigid::Vec3 off(4.1e5, 5.2e6, -312);
  const Told near = stream_past_gear(rigid::Vec3::Zero(), "");
  const Told far = stream_past_gear(off, ", point = [15.7, 16.2, 16.4]"),
             about_origin = stream_past_gear(off, "");
  EXPECT_GT(std::fabs(near.torque), 1e-6);
  EXPECT_EQ(far.fluid_cells, near.fluid_cells);
  EXPECT_LT((far.momentum - near.momentum).norm(), 1e-6 * near.momentum.norm());
  EXPECT_NEAR(far.force_y, near.force_y, 1e-6 * near.force_y);
  EXPECT_NEAR(far.force_z, near.force_z, 1e-6 * near.force_z);
  EXPECT_NEAR(far.torque, near.torque, 1e-6 * std::fabs(near.torque));
  const double arms = 9 * (off[1] * about_origin.force_z - off[2] * about_origin.force_y);
  EXPECT_NEAR(about_origin.torque, far.torque + arms, 1e-12 * std::fabs(arms));
}

/// Two balls at rest on a cube, one on either side of the axis, the one in a block of its own: their weights
/// times their distances.
TEST(MeshWalls, TorqueOfBodiesIsTheirWeightTimesItsArm) {
  CaseText text = mesh_case("cube.ply", "solid = \"inside\"\nposition = [16, 16, 16]");
  text.fluid = "";
  text.shapes = shape_of("ball", "sphere", "radius = 2");
  text.bodies =
      "[[bodies]]\nshape = \"ball\"\ndensity = 2\nposition = [26, 21, 13]\n"
      "[[bodies]]\nshape = \"ball\"\ndensity = 3\nposition = [26, 13.5, 20]\n";
  text.run =
      "[gravity]\nacceleration = [-1e-4, 0, 0]\n[contacts]\nsubsteps = 2\n[run]\nsteps = 60\n"
      "[[quantities]]\nname = \"t\"\ntype = \"wall-torque\"\ntime = 30\n";
  const Case scene =
      read_with(text, {{"cube.ply", ply_of(rigid::testing::cuboid_mesh({-8, -8, -8}, {8, 8, 8}))}},
                {"domain.blocks=[16, 16, 16]"});
  Simulation simulation(scene, MPI_COMM_WORLD);
  const double volume = 4 * M_PI / 3 * 8;
  EXPECT_NEAR(values_of(simulation)[0], 1e-4 * volume * (2 * 5 - 3 * 2.5), 1e-9);
}

}  // namespace
}  // namespace silt::coupler::testing
