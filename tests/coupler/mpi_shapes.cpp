// Cylinder, ellipsoid and polyhedron in the fluid: they cover as many cells as they have volume, wherever
// they are, and give the fluid what it gives them.
#include <gtest/gtest.h>
#include <mpi.h>

#include <cstdio>
#include <numbers>
#include <string>

#include "coupler/simulation.hpp"
#include "lbm/wall_scheme.hpp"
#include "tests/coupler/case/case_text.hpp"
#include "tests/coupler/solid_cells.hpp"
#include "tests/world.hpp"

namespace silt::coupler::testing {
namespace {

using rigid::Vec3;
using std::numbers::pi;

/// An oblique frustum: it has no plane of symmetry, and its corners' origin is not its centre of mass.
constexpr const char* frustum =
    "vertices = [[0, 0, 0], [10, 0, 0], [10, 8, 0], [0, 8, 0], [3, 2, 9], [8, 2, 9], [8, 6, 9], [3, 6, 9]]\n";
constexpr double frustum_volume = 9. / 3 * (80 + 20 + 40);  // h / 3 (A + B + sqrt(A B))

struct Body {
  const char *type, *sizes;
  double volume;
};
const Body all[] = {{"cylinder", "diameter = 8\nlength = 10\n", pi * 16 * 10},
                    {"ellipsoid", "diameters = [12, 7, 9]\n", pi / 6 * 12 * 7 * 9},
                    {"polyhedron", frustum, frustum_volume}};

CaseText alone(const Body& body) {
  CaseText c;
  c.domain = "[domain]\nsize = [24, 22, 26]\nboundary = \"periodic\"\n";
  c.fluid =
      "[fluid]\nrelaxation_time = 0.8\nprecision = \"double\"\n[coupling]\nforce = "
      "\"exact\"\nmass_correction = "
      "false\n";
  c.shapes = std::string("[[shapes]]\nname = \"ball\"\ntype = \"") + body.type + "\"\n" + body.sizes;
  c.bodies =
      "[[bodies]]\nshape = \"ball\"\ndensity = 2\norientation = [0.8, 0.3, -0.4, 0.5]\n"
      "position = [2.3, 20.1, 13.7]\nvelocity = [0.03, 0.01, -0.02]\nangular_velocity = [0.004, 0.003, "
      "-0.005]\n";
  return c;
}

TEST(Shapes, CoverTheirVolumeAndKeepMomentum) {
  for (const Body& body : all) {
    Simulation s = alone(body).start(MPI_COMM_WORLD, {"domain.blocks=[12,11,13]"});
    const Vec3 before = s.balance().momentum;
    double mass = 0, cells = 0;
    for (std::size_t row = 0; row < s.bodies().owned; ++row) mass += s.bodies().mass[row];
    EXPECT_NEAR(tests::sum_over_ranks(mass), 2 * body.volume, 1e-9 * body.volume) << body.type;
    const int looks = 20, steps_a_look = 5;
    for (int look = 0; look < looks; ++look) {
      cells += solid_cells(s) / looks;
      for (int t = 0; t < steps_a_look; ++t) s.step();
    }
    EXPECT_NEAR(cells / body.volume, 1, 0.01) << body.type << ": 20 places, 1 or 2 % each";
    EXPECT_GT(s.counters().uncovered, 0u);
    const double scale = 2 * body.volume * Vec3(0.03, 0.01, -0.02).norm();
    EXPECT_LT((s.balance().momentum - before).norm(), 1e-11 * scale) << body.type;
  }
}

TEST(Shapes, SameBitsOnAnyNumberOfRanksAndBlocks) {
  for (const Body& body : all) {
    const auto hash = [&](const char* blocks, MPI_Comm comm) {
      Simulation s = alone(body).start(comm, {blocks});
      while (s.steps_done() < 20) s.step();
      return s.hash();
    };
    const auto one = tests::alone([&] { return hash("domain.blocks=\"auto\"", MPI_COMM_SELF); });
    EXPECT_EQ(hash("domain.blocks=[12,11,13]", MPI_COMM_WORLD), one) << body.type;
  }
}

// Links across its edges are cut at both ends, which may be in two blocks, or in one through a period.
TEST(Shapes, ATurningBoxHasTheSameBitsUnderAnyWallScheme) {
  const Body box{"box", "edges = [8, 7, 6]\n", 8 * 7 * 6};
  for (const auto name : lbm::wall_scheme_names)
    for (const char* precision : {"single", "double"}) {
      const auto hash = [&](const char* blocks, MPI_Comm comm) {
        Simulation s =
            alone(box).start(comm, {blocks, "coupling.wall_scheme=" + std::string(name),
                                    std::string("fluid.precision=") + precision, "coupling.force=galilean"});
        while (s.steps_done() < 41) s.step();
        return s.hash();
      };
      const auto one = tests::alone([&] { return hash("domain.blocks=\"auto\"", MPI_COMM_SELF); });
      for (const char* blocks : {"domain.blocks=[12,11,13]", "domain.blocks=[3,22,2]"})
        EXPECT_EQ(hash(blocks, MPI_COMM_WORLD), one) << name << " " << precision << " " << blocks;
    }
}

}  // namespace
}  // namespace silt::coupler::testing
