// Tubes and rotors of triangles as walls of the fluid, on any ranks: the same bits in any blocks, with a file
// in any order and in a run that goes on.
#include <gtest/gtest.h>

#include <algorithm>
#include <random>

#include "silt/simulation.hpp"
#include "tests/coupler/rotor_case.hpp"
#include "tests/silt/case/mesh_case.hpp"
#include "tests/silt/case/pipe_case.hpp"
#include "tests/silt/same_bits.hpp"
#include "tests/world.hpp"

namespace silt::coupler::testing {
namespace {

/// Blocks of nothing but wall do not collide: the same bits as with one block.
TEST(Tube, SameBitsForAnyBlocksAndRanks) {
  CaseText c = pipe(6.2, "angular_velocity = 0.002", 1e-5, 1);
  c.domain = domain_of({16, 32, 32},
                       R"({ x = "periodic", y = ["no-slip", "no-slip"], z = ["no-slip", "no-slip"] })");
  c.rest =
      "[gravity]\nacceleration = [0, 0, -1e-4]\n"
      "[[walls]]\ntype = \"tube\"\nradius = 11\naxis = [1, 0, 0]\npoint = [3, 16.2, 16.4]\nangular_velocity "
      "= 1e-3\n";
  c.shapes = CaseText().shapes;
  c.bodies = body_of("ball", 2, "positions = [[4, 16, 9.5], [13, 14, 20]]");
  expect_one_hash(c, 150, {"[8, 8, 8]", "[16, 4, 4]"});
}

/// The blocks beside the tube are solid and keep what they were given at the start, which no fluid may see: a
/// run that goes on has something else there.
TEST(Tube, EndsAtFreeSlipSides) {
  CaseText c;
  c.domain =
      domain_of({32, 24, 26},
                R"({ x = "no-slip", y = "no-slip", z = { type = "free-slip", solid_for_bodies = false } })");
  c.fluid = "[fluid]\nrelaxation_time = 0.7\nquiet_start = true\nbody_force = [2e-5, 1e-5, 0]\n";
  c.rest = "[[walls]]\ntype = \"tube\"\nradius = 7.9\naxis = [0, 0, 1]\npoint = [16, 11.8, 0]\n";
  c.bodies = body_of("ball", 1.4,
                     "positions = [[16, 13.5, 4.4], [15, 10, 23]]\nvelocity = [0.01, 0.02, -0.01]\n"
                     "angular_velocity = [0.004, 0.003, 0.01]");
  expect_one_hash(c, 60, {"[8, 8, 8]", "[8, 6, 13]"});
  Simulation simulation = c.start(MPI_COMM_WORLD, {"domain.blocks=[8, 8, 8]"});
  simulation.run(20);
  expect_goes_on(simulation, 20);
}

const std::string turning =
    "{ angular_velocity = 0.004, axis = [0.2, 0.1, 1], amplitude = [0.5, 0, 0.3], frequency = 0.01 }";

std::uint64_t hash_of(const CaseText& text, const Files& files, MPI_Comm comm, const Overrides& overrides) {
  Simulation simulation(read_with(text, files, overrides), comm);
  simulation.run(60);
  return simulation.hash();
}

TEST(MeshWalls, SameBitsForAnyBlocksAndRanks) {
  for (const std::string force : {"galilean", "exact"}) {
    const std::uint64_t alone = expect_one_hash(
        [&](MPI_Comm comm, Overrides cut) {
          cut.push_back("coupling.force=" + force);
          return Simulation(read_with(rotor_case(turning), gear(), cut), comm);
        },
        60, {"[16, 16, 16]", "[32, 8, 8]"});
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

/// One of the rotors is mapped in every seventh step, and goes on between two mappings.
TEST(MeshWalls, ARunGoesOnToTheSameBits) {
  for (const std::string& motion :
       {turning, std::string("{ angular_velocity = 0.0005, axis = [0.2, 0.1, 1] }")}) {
    SCOPED_TRACE(motion);
    Simulation simulation(read_with(rotor_case(motion), gear()), MPI_COMM_WORLD);
    simulation.run(30);
    expect_goes_on(simulation, 30);
  }
}

/// A wall that turns beside its centre, and cells that it covers and leaves at the borders of blocks.
TEST(MeshWalls, TheSameLoadOnAnyRanks) {
  const CaseText text =
      rotor_case("{ angular_velocity = 0.004, axis = [0.2, 0.1, 1], point = [17, 15, 16.4] }");
  for (const std::string force : {"galilean", "exact"}) {
    const auto load = [&](MPI_Comm comm, Overrides cut) {
      cut.push_back("coupling.force=" + force);
      Simulation simulation(read_with(text, gear(), cut), comm);
      simulation.run(60);
      return load_on_wall(simulation);
    };
    EXPECT_EQ(load(MPI_COMM_WORLD, {"domain.blocks=[16, 8, 8]"}), load(MPI_COMM_SELF, {}));
  }
}

}  // namespace
}  // namespace silt::coupler::testing
