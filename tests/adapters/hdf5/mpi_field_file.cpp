// Files of fields, and the exchange of slices among ranks by which files are written.
#include <cstring>
#include <random>

#include <nlohmann/json.hpp>

#include "adapters/hdf5/field_file.hpp"
#include "adapters/hdf5/slice_exchange.hpp"
#include "tests/act.hpp"
#include "tests/adapters/hdf5/scratch.hpp"

namespace silt::tests {
namespace {

using adapters::CellBox;
using adapters::FieldQuantity;
using adapters::hdf5::SliceExchange;
using Run = SliceExchange::Run;

constexpr std::array<int, 3> grid_cells{13, 8, 21};
const adapters::ImageGrid grid{grid_cells, {-1, 0, 2}, {0.5, 0.5, 0.5}, "m", "s"};
const adapters::Provenance provenance = tests::made_from("title = \"a title\"\n");

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
           double time = 1.5, std::int64_t step = 100, adapters::FieldPlan plan = {}) {
  adapters::write_fields(comm, path, boxes, {grid, quantities(boxes), time, step, plan}, provenance);
}

TEST(FieldFile, is_the_same_on_any_number_of_ranks) {
  const Scratch scratch;
  for (const bool in_turn : {true, false})
    for (const bool idle : {true, false}) {
      write(MPI_COMM_WORLD, scratch / "many.hdf",
            blocks_of(rank(), ranks(), grid_cells, {4, 8, 5}, in_turn, idle));
      if (rank() == 0) {
        write(MPI_COMM_SELF, scratch / "one.hdf", {{{0, 0, 0}, {13, 8, 21}}});
        const std::string one = content(scratch / "one.hdf"), many = content(scratch / "many.hdf");
        EXPECT_GT(one.size(), 13u * 8 * 21 * (4 + 12 + 8 + 1));
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
void write_levels(MPI_Comm comm, const std::filesystem::path& path) {
  std::vector<CellBox> fine = blocks_of(rank(), ranks(), {12, 8, 21}, {4, 8, 5}),
                       coarse = blocks_of(rank(), ranks(), {6, 4, 4}, {3, 3, 4}, false, true);
  std::erase_if(fine, [](CellBox& box) {
    box = overlap(box, {{0, 0, 8}, {12, 8, 13}});
    return box.cells() == 0;
  });
  adapters::write_fields(
      comm, path, {{1, fine, quantities(fine)}, {2, coarse, quantities(coarse)}, {4, {}, quantities({})}},
      {grid, {}, 1.5, 100}, provenance);
}

// The writer for reads_in_vtk.py, which sets the variable.
const Act write_fields("write_fields", [] {
  const std::filesystem::path folder = std::getenv("SILT_TEST_FOLDER");
  for (const int step : {0, 50, 100, 150, 60, 70}) {  // other steps than foreseen, from 60 on
    const auto boxes = blocks_of(rank(), ranks(), grid_cells, {4, 8, 5}, step == 0, true);
    write(MPI_COMM_WORLD, adapters::step_path(folder, "fields", step, ".hdf"), boxes, 0.01 * step, step,
          {step < 60 || step >= 100 ? 50 : 60, 180, 0.01});
  }
  write_levels(MPI_COMM_WORLD, folder / "levels.hdf");
});

/// Cuts [0, n) into runs of odd lengths, deals them to the ranks at random, and leaves every fifth to nobody.
std::vector<Run> dealt(std::uint64_t n) {
  std::mt19937 random(n);
  std::vector<Run> mine;
  for (std::uint64_t first = 0, k = 0; first < n; ++k) {
    const std::uint64_t length = std::min<std::uint64_t>(1 + random() % 9, n - first);
    if (k % 5 && int(random() % ranks()) == rank()) mine.push_back({first, length});
    first += length;
  }
  return mine;
}

std::uint32_t value(std::uint64_t place) {
  return static_cast<std::uint32_t>(3 * place + 1);
}

std::vector<std::byte> values_of(const std::vector<Run>& runs) {
  std::vector<std::byte> values;
  for (const Run& run : runs)
    for (std::uint64_t k = 0; k < run.length; ++k) parallel::put(values, value(run.first + k));
  return values;
}

/// The whole array with what all ranks have.
std::vector<std::byte> whole_array(std::uint64_t n, const std::vector<Run>& runs) {
  std::vector<std::uint32_t> all(n, 0);
  for (const Run& run : runs)
    for (std::uint64_t k = 0; k < run.length; ++k) all[run.first + k] = value(run.first + k);
  MPI_Allreduce(MPI_IN_PLACE, all.data(), int(n), MPI_UINT32_T, MPI_SUM, MPI_COMM_WORLD);
  std::vector<std::byte> bytes(4 * n);
  if (n > 0) std::memcpy(bytes.data(), all.data(), bytes.size());
  return bytes;
}

TEST(SliceExchange, takes_values_to_slices_and_back) {
  for (const auto& [n, grain] :
       {std::pair<std::uint64_t, std::uint64_t>{0, 1}, {1, 1}, {5, 1}, {6, 3}, {1000, 1}, {1001, 7}}) {
    const auto runs = dealt(n);
    const SliceExchange slices(MPI_COMM_WORLD, n, runs, grain);
    const auto all = whole_array(n, runs), values = values_of(runs), slice = slices.to_slice(4, values);
    ASSERT_EQ(slice.size(), 4 * slices.slice_size());
    EXPECT_EQ(slices.slice_begin() % grain, 0u);
    EXPECT_LE(slices.slice_size(), n / ranks() + grain);
    EXPECT_TRUE(std::equal(slice.begin(), slice.end(), all.begin() + 4 * slices.slice_begin())) << n;
    EXPECT_EQ(sum_over_ranks(double(slices.slice_size())), double(n));
    EXPECT_TRUE(slices.from_slice(4, slice) == values) << n;
    for (const std::size_t piece : {4, 12, 20000}) {
      std::vector<std::byte> handed;
      adapters::hdf5::gather_in_pieces(slices.comm(), slice, piece, [&](std::span<const std::byte> more) {
        EXPECT_LE(more.size(), piece);
        handed.insert(handed.end(), more.begin(), more.end());
      });
      EXPECT_TRUE(rank() > 0 ? handed.empty() : handed == all) << n;
    }
  }
}

TEST(SliceExchange, readers_may_want_the_same) {
  const SliceExchange slices(MPI_COMM_WORLD, 100, {{10, 80}});
  std::vector<std::byte> slice;
  for (std::uint64_t k = 0; k < slices.slice_size(); ++k)
    parallel::put(slice, value(slices.slice_begin() + k));
  EXPECT_TRUE(slices.from_slice(4, slice) == values_of({{10, 80}}));
}

TEST(SliceExchange, an_error_of_rank_0_leaves_nobody_waiting) {
  const SliceExchange slices(MPI_COMM_WORLD, 1000, {});
  const auto slice = slices.to_slice(8, {});
  EXPECT_TEXT(error_of([&] {
                adapters::hdf5::gather_in_pieces(slices.comm(), slice, 80,
                                                 [](auto) { throw std::runtime_error("no room"); });
              }),
              "no room");
}

TEST(SliceExchange, slices_of_1e16_elements) {
  const std::uint64_t planes = 1'000'000'000'000, plane = 10'000;
  const SliceExchange slices(MPI_COMM_WORLD, planes * plane, {{planes * plane - 1, 1}}, plane);
  EXPECT_EQ(slices.slice_begin(), planes * rank() / ranks() * plane);
  EXPECT_EQ(slices.slice_begin() + slices.slice_size(), planes * (rank() + 1) / ranks() * plane);
}

/// With ids at both ends of a range of 2^40.
TEST(OrderById, of_ids_far_apart) {
  const std::uint64_t n = std::uint64_t{1} << 40;
  const auto order = adapters::hdf5::order_by_id(
      MPI_COMM_WORLD, std::vector<std::uint64_t>{n - 1 - rank(), std::uint64_t(rank())});
  ASSERT_EQ(order.total, std::uint64_t(2 * ranks()));
  EXPECT_FALSE(order.twice);
  ASSERT_EQ(order.rows, (std::vector<std::size_t>{1, 0}));
  EXPECT_EQ(order.places.front().first, std::uint64_t(rank()));
  const SliceExchange::Run last = order.places.back();
  EXPECT_EQ(last.first + last.length, std::uint64_t(2 * ranks() - rank()));
}

}  // namespace
}  // namespace silt::tests
