// Bodies of every shape in the fluid, meshes of triangles among them: they cover as many cells as they have
// volume, conserve momentum, and have the same bits on any ranks.
#include <fmt/format.h>
#include <gtest/gtest.h>
#include <mpi.h>

#include <cmath>
#include <numbers>
#include <string>

#include "lbm/walls/wall_scheme.hpp"
#include "silt/simulation.hpp"
#include "tests/coupler/single_cells.hpp"
#include "tests/silt/case/case_text.hpp"
#include "tests/silt/case/mesh_case.hpp"
#include "tests/silt/same_bits.hpp"
#include "tests/world.hpp"

namespace silt::coupler::testing {

/// Counts the cells that are in bodies and walls; collective.
inline double solid_cells(const Simulation& s) {
  const FluidFields& fields = s.scene().flow->fields();
  double count = 0;
  for_each_cell(fields, [&](int b, lbm::Int3 x, lbm::Int3) { count += !fields.is_fluid(b, x); });
  return tests::sum_over_ranks(count);
}

namespace {

using rigid::Vec3;
using std::numbers::pi;

/// An oblique frustum: it has no plane of symmetry, and its corners' origin is not its centre of mass.
constexpr const char* frustum =
    "vertices = [[0, 0, 0], [10, 0, 0], [10, 8, 0], [0, 8, 0], [3, 2, 9], [8, 2, 9], [8, 6, 9], [3, 6, 9]]";
constexpr double frustum_volume = 9. / 3 * (80 + 20 + 40);  // h / 3 (A + B + sqrt(A B))
const rigid::TriangleMesh torus = rigid::testing::torus_mesh(6, 2.5, 40, 20);
const std::string torus_shape = shape_of("body", "mesh", "file = \"torus.ply\"");

struct Body {
  std::string shape;
  double volume;
};
std::vector<Body> bodies() {
  return {{shape_of("body", "cylinder", "diameter = 8\nlength = 10"), pi * 16 * 10},
          {shape_of("body", "ellipsoid", "diameters = [12, 7, 9]"), pi / 6 * 12 * 7 * 9},
          {shape_of("body", "polyhedron", frustum), frustum_volume},
          {torus_shape, torus.mass_properties().volume}};
}

constexpr const char* motion = "\nvelocity = [0.03, 0.01, -0.02]\nangular_velocity = [0.004, 0.003, -0.005]";

/// One body that moves and turns in a periodic box.
CaseText alone(const std::string& shape) {
  CaseText c;
  c.domain = domain_of({28, 26, 24});
  c.fluid = "[fluid]\nrelaxation_time = 0.8\nprecision = \"double\"\n";
  c.rest = "[coupling]\nforce = \"exact\"\n";
  c.shapes = shape;
  c.bodies = body_of(
      "body", 2, fmt::format("orientation = [0.8, 0.3, -0.4, 0.5]\nposition = [2.3, 24.1, 13.7]{}", motion));
  return c;
}
Case read(const CaseText& text, const Overrides& overrides = {}) {
  return read_with(text, {{"torus.ply", ply_of(torus)}}, overrides);
}

TEST(Shapes, CoverTheirVolumeAndKeepMomentum) {
  for (const auto& [shape, volume] : bodies()) {
    Simulation s(read(alone(shape), {"domain.blocks=[14,13,12]"}), MPI_COMM_WORLD);
    const Vec3 before = s.balance().momentum;
    double mass = 0, cells = 0;
    for (std::size_t row = 0; row < s.bodies().owned; ++row) mass += s.bodies().mass[row];
    EXPECT_NEAR(tests::sum_over_ranks(mass), 2 * volume, 1e-9 * volume) << shape;
    const int looks = 20, steps_a_look = 5;
    for (int look = 0; look < looks; ++look) {
      cells += solid_cells(s) / looks;
      s.run(steps_a_look);
    }
    EXPECT_NEAR(cells / volume, 1, 0.01) << shape << "in 20 places, 1 or 2 % each";
    EXPECT_GT(s.counters().uncovered, 0u);
    const double scale = 2 * volume * Vec3(0.03, 0.01, -0.02).norm();
    EXPECT_LT((s.balance().momentum - before).norm(), 1e-11 * scale) << shape;
  }
}

void expect_same_bits(const std::string& shape, int steps, const Overrides& overrides,
                      std::initializer_list<const char*> blocks) {
  SCOPED_TRACE(shape + ::testing::PrintToString(overrides));
  expect_one_hash(
      [&](MPI_Comm comm, Overrides cut) {
        cut.insert(cut.end(), overrides.begin(), overrides.end());
        return Simulation(read(alone(shape), cut), comm);
      },
      steps, blocks);
}

TEST(Shapes, SameBitsOnAnyNumberOfRanksAndBlocks) {
  for (const Body& body : bodies()) expect_same_bits(body.shape, 20, {}, {"[14,13,12]"});
  for (const char* precision : {"single", "double"})
    for (const char* force : {"galilean", "exact"})
      expect_same_bits(torus_shape, 60,
                       {std::string("fluid.precision=") + precision, std::string("coupling.force=") + force},
                       {"[14,13,12]", "[4,26,6]"});
}

// Links across its edges are cut at both ends, which may be in two blocks, or in one through a period.
TEST(Shapes, ATurningBoxHasTheSameBitsUnderAnyWallScheme) {
  for (const auto name : lbm::wall_scheme_names)
    for (const char* precision : {"single", "double"})
      expect_same_bits(shape_of("body", "box", "edges = [8, 7, 6]"), 41,
                       {"coupling.wall_scheme=" + std::string(name),
                        std::string("fluid.precision=") + precision, "coupling.force=galilean"},
                       {"[14,13,12]", "[4,26,2]"});
}

/// The origin of its file far outside the domain, or the centre in the domain's next period; placed by either
/// point. Numbers of map coordinates keep 1e-9 of a cell.
TEST(MeshBodies, FarFromItsFilesOriginABodyIsWhatItIsNearIt) {
  const auto run = [&](const Vec3& off, const std::string& position) {
    CaseText c = alone(torus_shape);
    c.bodies = body_of("body", 2, position + motion);
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

}  // namespace

}  // namespace silt::coupler::testing
