// Files of a fluid of several levels: fields, and checkpoints that any number of ranks go on from.
#include <gtest/gtest.h>
#include <mpi.h>

#include "silt/results/checkpoint.hpp"
#include "silt/results/flow_fields.hpp"
#include "silt/results/lattice_of_levels.hpp"
#include "silt/results/quantity_computation.hpp"
#include "tests/adapters/hdf5/scratch.hpp"
#include "tests/coupler/levelled_flow.hpp"
#include "tests/world.hpp"

namespace silt::testing {
namespace {

using namespace coupler;
using namespace coupler::testing;

using tests::Scratch;

/// A shear flow along x whose speed is a function of y and z, and the number of each cell as its density.
LocalFlow numbered(const FluidFields& fields, lbm::Int3 cell) {
  const rigid::Vec3 x = fields.centre(cell);
  return {1e-5 * (cell.x + 24 * cell.y + 24 * 16 * cell.z), {1e-4 * x[1] - 3e-4 * x[2], 0, 0}};
}

/// Calls expect(finest cell inside, width of its cell, values) for each finest cell of this rank.
template <class Expect>
void for_each_here(const FieldHere& here, Expect&& expect) {
  const auto& [low, size] = here.box;
  const double* value = here.values.data();
  for_cells(low, low + size, [&](lbm::Int3 x) {
    expect(x, x.x < 8 ? 4 : x.x < 16 ? 2 : 1, value);
    value += here.components;
  });
}

TEST(FieldsOfLevels, RepeatACoarseCellInTheFinestOnes) {
  Simulation s = levelled_case().start(MPI_COMM_WORLD);
  set_cells(put_levels(s), numbered);
  for_each_here(field_here(s, Field::density), [](lbm::Int3 x, int width, const double* density) {
    const int number = x.x / width + 24 * (x.y / width) + 24 * 16 * (x.z / width);
    ASSERT_NEAR(*density, 1 + 1e-5 * number, 1e-12) << x.x << " " << x.y << " " << x.z;
  });
}

/// Differences within a level, one-sided at its borders, are exact for a linear velocity; along the periodic
/// axes it is not linear across the sides.
TEST(FieldsOfLevels, VorticityIsThatOfTheFinestUnits) {
  Simulation s = levelled_case().start(MPI_COMM_WORLD);
  set_cells(put_levels(s), numbered);
  int looked_at = 0;
  for_each_here(field_here(s, Field::vorticity), [&](lbm::Int3 x, int width, const double* vorticity) {
    if (width == 4 || x.y < width || x.y >= 16 - width || x.z < width || x.z >= 8 - width) return;
    ++looked_at;
    EXPECT_NEAR(vorticity[0], 0, 1e-12);
    EXPECT_NEAR(vorticity[1], -3e-4, 1e-12);
    EXPECT_NEAR(vorticity[2], -1e-4, 1e-12);
  });
  EXPECT_EQ(tests::sum_over_ranks(looked_at), 8 * 12 * 4 + 8 * 14 * 6);
}

/// A flow that grows linearly along an axis, through planes across it: between the centres of cells, on
/// borders between cells of two widths, and on the sides of the domain.
TEST(QuantitiesOfLevels, TheFlowThroughAPlaneIsLinearBetweenCells) {
  CaseText text = levelled_case();
  text.domain = domain_of({24, 16, 8}, R"("no-slip")");
  Simulation s = text.start(MPI_COMM_WORLD);
  LevelledFlow& flow = put_levels(s);
  for (int axis = 0; axis < 3; ++axis) {
    set_cells(flow, [axis](const FluidFields& fields, lbm::Int3 cell) {
      rigid::Vec3 u(1e-3, 2e-3, 3e-3);
      u[axis] += 1e-3 * fields.centre(cell)[axis];
      return LocalFlow{1e-4 * fields.centre(cell)[axis], u};
    });
    const double length = s.setup().cells[axis], area = s.setup().volume() / length;
    QuantitySpec q;
    q.type = "flow-rate", q.axis = axis;
    for (double share = 0; share <= 1; share += 1. / 64) {
      q.height = share * length;
      EXPECT_NEAR(value_in_last_step(s, q) / area, 1e-3 * (1 + axis + q.height), 1e-13)
          << "xyz"[axis] << " " << q.height;
      QuantitySpec drop = q;
      drop.type = "pressure-drop", drop.second_height = 1.5;
      EXPECT_NEAR(value_in_last_step(s, drop), 1e-4 * (drop.height - 1.5) / 3, 1e-15);
    }
  }
}

/// VTK wants cells of the next level under all: means of what is above.
TEST(FieldsOfLevels, ALatticeOfWideCellsHasMeansOfNarrowOnes) {
  const auto value = [](int x, int y, int z) { return x + 10. * y + 100. * z; };
  const std::vector<LevelBoxes> levels{{1, {{{6, 2, 4}, {2, 3, 4}}}}, {2, {{{0, 1, 2}, {3, 1, 2}}}}};
  std::vector<adapters::FieldQuantity> of_levels;
  for (const LevelBoxes& level : levels)
    of_levels.push_back({"value", "1", 1, [&value, &level](std::size_t b, int first, int last, double* out) {
                           const auto& [low, size] = level.boxes[b];
                           for_cells(low + lbm::Int3{0, 0, first}, low + lbm::Int3{size.x, size.y, last},
                                     [&](lbm::Int3 x) { *out++ = level.width * value(x.x, x.y, x.z); });
                         }});
  const LatticeOfLevels wide(levels, 2, {{0, 0, 0}, {9, 9, 9}});
  ASSERT_EQ(wide.boxes().size(), 2u);
  EXPECT_EQ(wide.boxes()[0].lower, (lbm::Int3{3, 1, 2}));
  EXPECT_EQ(wide.boxes()[0].size, (lbm::Int3{1, 2, 2}));
  std::vector<double> found(2);
  wide.quantity(of_levels).values(0, 1, 2, found.data());
  EXPECT_EQ(found[0], value(6, 2, 6) + 0.5 * (1 + 10 + 100));
  EXPECT_EQ(found[1], value(6, 4, 6) + 0.5 * (1 + 100)) << "a row of it alone is there";
  const LatticeOfLevels narrow(levels, 1, {{1, 3, 0}, {8, 1, 6}});
  ASSERT_EQ(narrow.boxes().size(), 2u);
  EXPECT_EQ(narrow.boxes()[1].lower, (lbm::Int3{1, 3, 4}));
  EXPECT_EQ(narrow.boxes()[1].size, (lbm::Int3{5, 1, 2}));
  found.resize(5);
  narrow.quantity(of_levels).values(1, 1, 2, found.data());
  EXPECT_EQ(found, (std::vector<double>{2 * value(0, 1, 2), 2 * value(1, 1, 2), 2 * value(1, 1, 2),
                                        2 * value(2, 1, 2), 2 * value(2, 1, 2)}));
}

void write(MPI_Comm comm, const std::filesystem::path& path, const Case& scene, const Flow& flow) {
  adapters::CheckpointWriter writer(comm, path, {});
  write_populations(writer, scene, flow);
  writer.commit(0);
}

std::uint64_t hash_of(MPI_Comm comm, const Flow& flow) {
  std::uint64_t sum = 0;
  flow.for_levels([&](const FluidFields& fields) { sum += fields.hash(); });
  MPI_Allreduce(MPI_IN_PLACE, &sum, 1, MPI_UINT64_T, MPI_SUM, comm);
  return sum;
}

TEST(PopulationsOfLevels, AreTheSameFromAndForAnyRanks) {
  const Scratch scratch;
  Case scene = levelled_case().read();
  scene.coarsening.emplace().levels = 2;
  LevelledFlow flow(scene, three_levels(tests::ranks()), 3, MPI_COMM_WORLD);
  set_cells(flow, numbered);
  write(MPI_COMM_WORLD, scratch / "many.h5", scene, flow);
  const std::uint64_t hash = hash_of(MPI_COMM_WORLD, flow);
  if (tests::rank() == 0) {
    LevelledFlow one(scene, three_levels(1), 3, MPI_COMM_SELF);
    const adapters::CheckpointReader reader(MPI_COMM_SELF, scratch / "many.h5");
    EXPECT_EQ(fault_of_populations(reader, scene), "");
    read_populations(reader, scene, one);
    EXPECT_EQ(hash_of(MPI_COMM_SELF, one), hash);
    write(MPI_COMM_SELF, scratch / "one.h5", scene, one);
    EXPECT_TRUE(tests::content(scratch / "one.h5") == tests::content(scratch / "many.h5"));
    const std::vector<lbm::LevelBox> found = saved_levels(reader, 2, {{0, 0, 0}, {24, 16, 8}});
    ASSERT_EQ(found.size(), 3u);
    for (int level = 0; level < 3; ++level) {
      EXPECT_EQ(found[level].level, level);
      EXPECT_EQ(found[level].box.lower, (lbm::Int3{16 - 8 * level, 0, 0}));
      EXPECT_EQ(found[level].box.size, (lbm::Int3{8, 16, 8}));
    }
  }
  MPI_Barrier(MPI_COMM_WORLD);
  LevelledFlow again(scene, three_levels(tests::ranks()), 3, MPI_COMM_WORLD);
  const adapters::CheckpointReader reader(MPI_COMM_WORLD, scratch / "one.h5");
  read_populations(reader, scene, again);
  EXPECT_EQ(hash_of(MPI_COMM_WORLD, again), hash);
  scene.coarsening.reset();
  EXPECT_EQ(fault_of_populations(reader, scene),
            "its cells are of several levels, and those of the case are not");
}

}  // namespace
}  // namespace silt::testing
