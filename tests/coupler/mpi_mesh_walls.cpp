// A rotor of triangles: the same bits on any number of ranks, in any blocks, with its file in any order, and
// in a run that goes on; and the power that it takes.
#include <fmt/format.h>
#include <gtest/gtest.h>
#include <mpi.h>

#include <algorithm>
#include <random>

#include "coupler/results/build_info.hpp"
#include "coupler/results/checkpoint.hpp"
#include "coupler/results/quantities.hpp"
#include "tests/adapters/hdf5/scratch.hpp"
#include "tests/coupler/case/mesh_case.hpp"
#include "tests/world.hpp"

namespace silt::coupler::testing {
namespace {

CaseText rotor_case(const std::string& motion) {
  CaseText c =
      mesh_case("gear.ply",
                "scale = 9\nsolid = \"inside\"\nposition = [15.7, 16.2, 16.4]\naxis = [0.2, 0.1, 1]\n"
                "motion = " +
                    motion);
  c.fluid = "[fluid]\nrelaxation_time = 0.7\n";
  return c;
}
const std::string turning =
    "{ angular_velocity = 0.004, axis = [0.2, 0.1, 1], oscillation = { amplitude = [0.5, 0, 0.3], frequency "
    "= 0.01 } }";

Files gear() {
  return {{"gear.ply", ply_of(rigid::testing::gear_mesh(7, 3))}};
}

std::uint64_t hash_of(const CaseText& text, const Files& files, MPI_Comm comm, const Overrides& overrides) {
  Simulation simulation(read_with(text, files, overrides), comm);
  simulation.run(60);
  return simulation.hash();
}

TEST(MeshWalls, SameBitsForAnyBlocksAndRanks) {
  for (const std::string force : {"galilean", "exact"}) {
    const auto hash = [&](const std::string& blocks, MPI_Comm comm) {
      return hash_of(rotor_case(turning), gear(), comm,
                     {"domain.blocks=" + blocks, "coupling.force=" + force});
    };
    const std::uint64_t alone = tests::alone([&] { return hash("[32, 32, 32]", MPI_COMM_SELF); });
    EXPECT_EQ(hash("[16, 16, 16]", MPI_COMM_WORLD), alone) << force;
    EXPECT_EQ(hash("[32, 8, 8]", MPI_COMM_WORLD), alone) << force;
    EXPECT_NE(
        hash_of(rotor_case("{ angular_velocity = 0.003, axis = [0.2, 0.1, 1] }"), gear(), MPI_COMM_WORLD, {}),
        alone);
  }
}

TEST(MeshWalls, SameBitsWithTheFileInAnyOrder) {
  const rigid::TriangleMesh mesh = rigid::testing::gear_mesh(7, 3);
  std::string obj;
  std::vector<std::size_t> order(mesh.triangles().size());
  for (std::size_t k = 0; k < order.size(); ++k) order[k] = k;
  std::shuffle(order.begin(), order.end(), std::mt19937(3));
  char line[120];
  for (const std::size_t t : order) {  // every triangle with corners of its own
    for (const rigid::Vec3& x : mesh.corners(std::uint32_t(t))) {
      std::snprintf(line, sizeof line, "v %.17g %.17g %.17g\n", x[0], x[1], x[2]);
      obj += line;
    }
    obj += "f -2 -1 -3\n";
  }
  CaseText text = rotor_case(turning);
  text.rest.replace(text.rest.find("gear.ply"), 8, "gear.obj");
  EXPECT_EQ(hash_of(text, {{"gear.obj", obj}}, MPI_COMM_WORLD, {}),
            tests::alone([&] { return hash_of(rotor_case(turning), gear(), MPI_COMM_SELF, {}); }));
}

/// Also one that is mapped in every seventh step, between two mappings.
TEST(MeshWalls, ARunGoesOnToTheSameBits) {
  for (const std::string& motion :
       {turning, std::string("{ angular_velocity = 0.0005, axis = [0.2, 0.1, 1] }")}) {
    const tests::Scratch scratch;
    const Case scene = read_with(rotor_case(motion), gear());
    Simulation simulation(scene, MPI_COMM_WORLD);
    simulation.run(30);
    const auto path = write_checkpoint(simulation, Quantities(scene), scratch.path(),
                                       provenance_of(scene, tests::ranks(), "auto"), {});
    simulation.run(30);
    const adapters::CheckpointReader reader(MPI_COMM_WORLD, path);
    const auto going_on = resumed_simulation(reader, scene, MPI_COMM_WORLD);
    Simulation& again = *going_on;
    again.run(30);
    EXPECT_EQ(again.hash(), simulation.hash()) << motion;
  }
}

/// What turns the rotor is the torque of the fluid times its speed.
TEST(MeshWalls, PowerIsTorqueTimesAngularVelocity) {
  CaseText text = rotor_case("{ angular_velocity = 0.004, axis = [0.2, 0.1, 1] }");
  text.run =
      "[run]\nsteps = 200\n[[quantities]]\nname = \"t\"\ntype = \"wall-torque\"\ntime = 100\n"
      "[[quantities]]\nname = \"p\"\ntype = \"wall-power\"\ntime = 100\n";
  const Case scene = read_with(text, gear());
  Simulation simulation(scene, MPI_COMM_WORLD);
  Quantities quantities(scene);
  while (simulation.steps_done() < scene.steps) {
    simulation.step();
    quantities.observe(simulation);
  }
  const auto values = quantities.evaluate(simulation);
  EXPECT_LT(values[0].second, 0) << "the fluid holds it back";
  EXPECT_NEAR(values[1].second, -0.004 * values[0].second, 1e-9 * values[1].second);
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
  Quantities quantities(scene);
  while (simulation.steps_done() < scene.steps) {
    simulation.step();
    quantities.observe(simulation);
  }
  const auto values = quantities.evaluate(simulation);
  const FlowTotals totals = simulation.look_at_flow();
  return {values[0].second, values[1].second, values[2].second, totals.fluid_cells,
          rigid::Vec3(totals.momentum.data())};
}

/// Its file in map coordinates, whose numbers keep 1e-9 of a cell; the torque about the same point, and by
/// r x F about the file's origin.
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

/// A vane far from the point that it turns about: the power that it takes is its torque about that point
/// times its angular velocity.
TEST(MeshWalls, PowerOfAWallFarFromItsPointIsTorqueTimesAngularVelocity) {
  CaseText text = rotor_case("{ angular_velocity = 1e-5, axis = \"z\", point = [4000, 16, 16] }");
  text.run =
      "[run]\nsteps = 60\n[[quantities]]\nname = \"t\"\ntype = \"wall-torque\"\ntime = 0\n"
      "[[quantities]]\nname = \"p\"\ntype = \"wall-power\"\ntime = 0\n";
  const Case scene = read_with(text, gear());
  Simulation simulation(scene, MPI_COMM_WORLD);
  Quantities quantities(scene);
  while (simulation.steps_done() < scene.steps) {
    simulation.step();
    quantities.observe(simulation);
  }
  const auto values = quantities.evaluate(simulation);
  EXPECT_LT(values[0].second, 0) << "the fluid holds it back";
  EXPECT_NEAR(values[1].second, -1e-5 * values[0].second, 1e-9 * values[1].second);
}

/// Two balls at rest on a cube, one on either side of the axis, the one in a block of its own: their weights
/// times their distances.
TEST(MeshWalls, TorqueOfBodiesIsTheirWeightTimesItsArm) {
  CaseText text = mesh_case("cube.ply", "solid = \"inside\"\nposition = [16, 16, 16]");
  text.fluid = "";
  text.shapes = "[[shapes]]\nname = \"ball\"\ntype = \"sphere\"\nradius = 2\n";
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
  Quantities quantities(scene);
  while (simulation.steps_done() < scene.steps) {
    simulation.step();
    quantities.observe(simulation);
  }
  const double volume = 4 * M_PI / 3 * 8;
  EXPECT_NEAR(quantities.evaluate(simulation)[0].second, 1e-4 * volume * (2 * 5 - 3 * 2.5), 1e-9);
}

}  // namespace
}  // namespace silt::coupler::testing
