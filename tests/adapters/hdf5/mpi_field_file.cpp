// Fields written on several ranks equal those written on one, byte for byte.
#include "adapters/hdf5/field_file.hpp"

#include <nlohmann/json.hpp>

#include "tests/act.hpp"
#include "tests/adapters/hdf5/scratch.hpp"

namespace silt::tests {
namespace {

using adapters::CellBox;
using adapters::FieldQuantity;

constexpr std::array<int, 3> grid_cells{13, 8, 21};
const adapters::ImageGrid grid{grid_cells, {-1, 0, 2}, {0.5, 0.5, 0.5}, "m", "s"};
const adapters::Provenance provenance{"0.1.0", "abc", "a title", "title = \"a title\"\n", 1, "auto",
                                      "g++",   "",    ""};

double value(int x, int y, int z, int c) {
  return 0.1 * x + 10 * y - 1000.0 / (z + 1) + 0.01 * c;
}

/// A whole number of a byte.
int mark(int x, int y, int z) {
  return (x + 3 * y + 7 * z) % 256;
}

std::vector<FieldQuantity> quantities(const std::vector<CellBox>& boxes) {
  const auto fill = [&boxes](int components) {
    return [&boxes, components](std::size_t box, int first, int last, double* out) {
      CellBox planes = boxes[box];
      planes.lower.z += first, planes.size.z = last - first;
      for_each_cell(planes, [&](int x, int y, int z, std::size_t i) {
        for (int c = 0; c < components; ++c) out[i * components + c] = value(x, y, z, c);
      });
    };
  };
  const auto marks = [&boxes](std::size_t box, int first, int last, double* out) {
    CellBox planes = boxes[box];
    planes.lower.z += first, planes.size.z = last - first;
    for_each_cell(planes, [&](int x, int y, int z, std::size_t i) { out[i] = mark(x, y, z); });
  };
  return {{"density", "kg/m^3", 1, fill(1)},
          {"velocity", "m/s", 3, fill(3)},
          {"pressure", "Pa", 1, fill(1), adapters::Storage::double_},
          {"mark", "1", 1, marks, adapters::Storage::byte}};
}

void write(MPI_Comm comm, const std::filesystem::path& path, const std::vector<CellBox>& boxes,
           double time = 1.5, int compression = 0) {
  adapters::write_fields(comm, path, boxes, {grid, quantities(boxes), time, 100, compression}, provenance);
}

TEST(FieldFile, is_the_same_on_any_number_of_ranks) {
  const Scratch scratch;
  for (const int compression : {0, 4})
    for (const bool in_turn : {true, false})
      for (const bool idle : {true, false}) {
        write(MPI_COMM_WORLD, scratch / "many.hdf",
              blocks_of(rank(), ranks(), grid_cells, {4, 8, 5}, in_turn, idle), 1.5, compression);
        if (rank() == 0) {
          write(MPI_COMM_SELF, scratch / "one.hdf", {{{0, 0, 0}, {13, 8, 21}}}, 1.5, compression);
          const std::string one = content(scratch / "one.hdf"), many = content(scratch / "many.hdf");
          EXPECT_GT(one.size(), compression > 0 ? 1000u : 13u * 8 * 21 * (4 + 12 + 8 + 1));
          EXPECT_TRUE(one == many);
        }
      }
}

TEST(FieldFile, cells_no_rank_holds_are_zero) {
  const Scratch scratch;
  std::vector<CellBox> boxes = blocks_of(rank(), ranks(), grid_cells, {13, 8, 7});
  std::erase_if(boxes, [](const CellBox& b) { return b.lower[2] == 7; });
  write(MPI_COMM_WORLD, scratch / "part.hdf", boxes);
  if (rank() == 0) {
    EXPECT_GT(std::filesystem::file_size(scratch / "part.hdf"), 13u * 8 * 21 * 24);
  }
}

TEST(FieldFile, keeps_a_list_of_times_and_replaces_later_ones) {
  const Scratch scratch;
  const auto boxes = blocks_of(rank(), ranks(), grid_cells, {8, 8, 8});
  for (const double t : {0.0, 0.1, 0.2, 0.3, 0.15})
    write(MPI_COMM_WORLD, scratch / ("fields_00" + std::to_string(int(100 * t + 0.5)) + ".hdf"), boxes, t);
  if (rank() == 0) {
    EXPECT_EQ(nlohmann::json::parse(content(scratch / "fields.hdf.series"))["files"],
              nlohmann::json::parse(R"([{"name": "fields_000.hdf", "time": 0},
                                        {"name": "fields_0010.hdf", "time": 0.1},
                                        {"name": "fields_0015.hdf", "time": 0.15}])"));
  }
}

TEST(FieldFile, every_rank_is_told_of_one_ranks_error) {
  const Scratch scratch;
  auto boxes = blocks_of(rank(), ranks(), grid_cells, {4, 8, 5});
  if (rank() == ranks() - 1) boxes.push_back({{0, 0, 20}, {1, 1, 2}});
  EXPECT_TEXT(error_of([&] { write(MPI_COMM_WORLD, scratch / "a.hdf", boxes); }),
              "outside the lattice of 13 x 8 x 21");
  EXPECT_TEXT(error_of([&] { write(MPI_COMM_WORLD, scratch / "no" / "folder.hdf", {}); }), "folder.hdf");
  EXPECT_TRUE(rank() != 0 || std::filesystem::is_empty(scratch.path()));
}

/// Cells of three widths: those below z = 8 are two wide, above they are one wide, and none is four wide.
void write_levels(MPI_Comm comm, const std::filesystem::path& path, int compression) {
  std::vector<CellBox> fine = blocks_of(rank(), ranks(), {12, 8, 21}, {4, 8, 5}),
                       coarse = blocks_of(rank(), ranks(), {6, 4, 4}, {3, 3, 4}, false, true);
  std::erase_if(fine, [](CellBox& box) {
    box = overlap(box, {{0, 0, 8}, {12, 8, 13}});
    return box.cells() == 0;
  });
  adapters::write_fields(
      comm, path, {{1, fine, quantities(fine)}, {2, coarse, quantities(coarse)}, {4, {}, quantities({})}},
      {grid, {}, 1.5, 100, compression}, provenance);
}

// The writer for reads_in_vtk.py, which sets the variable.
const Act write_fields("write_fields", [] {
  const std::filesystem::path folder = std::getenv("SILT_TEST_FOLDER");
  for (const int step : {0, 50}) {
    const auto boxes = blocks_of(rank(), ranks(), grid_cells, {4, 8, 5}, step == 0, true);
    write(MPI_COMM_WORLD, adapters::step_path(folder, "fields", step, ".hdf"), boxes, 0.01 * step);
  }
  for (const int compression : {0, 4})
    write_levels(MPI_COMM_WORLD, folder / ("levels" + std::to_string(compression) + ".hdf"), compression);
});

}  // namespace
}  // namespace silt::tests
