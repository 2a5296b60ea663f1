// The series of the bodies: sorted by id from any ranks, appended after a resume, errors told to all. What is
// in the file is read by h5py in series_in_h5py.py, which also kills the writer.
#include "adapters/hdf5/body_series.hpp"

#include <malloc.h>

#include <cmath>

#include "tests/act.hpp"
#include "tests/adapters/hdf5/scratch.hpp"

namespace silt::tests {
namespace {

using adapters::BodyRow;
using adapters::BodySeries;

/// A tetrahedron with the corner that is not on the axes at a height; its faces are flat.
adapters::TriangleMesh tetrahedron(double height) {
  const double s = std::sqrt(1.0 / 3);
  return {{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, height}},
          {{0, 0, -1}, {0, -1, 0}, {s, s, s}, {-1, 0, 0}},
          {{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {2, 0, 3}},
          {{0, 0, 0}, {1, 1, 1}, {2, 2, 2}, {3, 3, 3}}};
}

/// Kinds of one part, two parts and none.
const adapters::BodySeriesInfo info{{{"light", 0.5, 800, {tetrahedron(1)}},
                                     {"heavy \u2605", 0.7, 1200, {tetrahedron(1), tetrahedron(1.5)}},
                                     {"without a mesh", 0.7, 1200, {}}},
                                    {0, 0, 0},
                                    {10, 10, 20},
                                    "m",
                                    "s",
                                    "kg",
                                    {.contacts = true}};

/// This rank's share of the bodies of a step: their number and owners change from step to step.
std::vector<BodyRow> bodies(int step, int rank, int ranks) {
  std::vector<BodyRow> rows;
  for (int id = 20 + step % 3; id > 0; --id) {
    if ((id + step) % ranks != rank) continue;
    BodyRow r{};
    r.id = id;
    r.kind = id % 2;
    r.image = {0, -id, step};
    for (int d = 0; d < 3; ++d) {
      r.position[d] = id + 0.1 * d + 0.001 * step;
      r.velocity[d] = std::sin(id * step + d);
      r.force[d] = -id * d;
    }
    r.orientation = {1, 0, 0, 1e-3 * step};
    r.mass = 0.5 * id;
    r.contact_force = {0, double(id), 0};
    r.contact_torque = {0, -double(step), 0};
    rows.push_back(r);
  }
  return rows;
}

void append(BodySeries& series, std::int64_t step, double time, const std::vector<BodyRow>& rows) {
  series.append(step, time, rows.size(), [&](std::size_t i) { return rows[i]; });
}

void append(MPI_Comm comm, BodySeries& series, int first, int last) {
  int r = 0, n = 1;
  MPI_Comm_rank(comm, &r);
  MPI_Comm_size(comm, &n);
  for (int step = first; step <= last; ++step) append(series, 10 * step, 0.5 * step, bodies(step, r, n));
}

TEST(BodySeries, is_the_same_on_any_number_of_ranks) {
  const Scratch scratch;
  const auto write = [&](MPI_Comm comm, const char* name) {
    auto series = BodySeries::create(comm, scratch / name, info, {});
    append(comm, series, 0, 12);
  };
  write(MPI_COMM_WORLD, "many.h5");
  if (rank() != 0) return;
  write(MPI_COMM_SELF, "one.h5");
  EXPECT_GT(content(scratch / "one.h5").size(), 13u * 20 * 100);
  EXPECT_TRUE(content(scratch / "one.h5") == content(scratch / "many.h5"));
}

TEST(BodySeries, needs_no_more_memory_the_longer_it_gets) {
  const Scratch scratch;
  if (rank() != 0) return;
  auto series = BodySeries::create(MPI_COMM_SELF, scratch / "long.h5", info, {});
  append(MPI_COMM_SELF, series, 0, 99);
  const std::size_t before = mallinfo2().uordblks;
  append(MPI_COMM_SELF, series, 100, 1099);  // 21 rows of 250 bytes each
  EXPECT_LT(mallinfo2().uordblks, before + 500'000);
}

TEST(BodySeries, goes_on_after_the_step_of_a_checkpoint) {
  const Scratch scratch;
  {
    auto series = BodySeries::create(MPI_COMM_WORLD, scratch / "b.h5", info, {});
    append(MPI_COMM_WORLD, series, 0, 9);
  }
  {
    auto resumed = BodySeries::open_for_append(MPI_COMM_WORLD, scratch / "b.h5", 45, info.columns);
    EXPECT_EQ(resumed.times(), rank() == 0 ? 5u : 0u);
    append(MPI_COMM_WORLD, resumed, 5, 6);
    EXPECT_EQ(resumed.times(), rank() == 0 ? 7u : 0u);
  }
  EXPECT_EQ(BodySeries::open_for_append(MPI_COMM_WORLD, scratch / "b.h5", -1, info.columns).times(), 0u);
}

TEST(BodySeries, errors_reach_every_rank) {
  const Scratch scratch;
  auto series = BodySeries::create(MPI_COMM_WORLD, scratch / "b.h5", info, {});
  std::vector<BodyRow> twice(2);
  for (BodyRow& row : twice) row.id = 5;
  EXPECT_TEXT(error_of([&] { append(series, 0, 0, twice); }), "body 5 has two owners in step 0");
  append(series, 3, 0, {});
  EXPECT_TEXT(error_of([&] { append(series, 3, 0, {}); }), "step 3 does not come after step 3");
  EXPECT_TEXT(error_of([&] { BodySeries::open_for_append(MPI_COMM_WORLD, scratch / "b.h5", 9); }),
              "its columns are not those of this run (contact_force)");
  EXPECT_TEXT(error_of([&] { BodySeries::open_for_append(MPI_COMM_WORLD, scratch / "c.h5", 0); }), "c.h5");
  EXPECT_TEXT(error_of([&] { BodySeries::create(MPI_COMM_WORLD, scratch / "no" / "b.h5", info, {}); }),
              "cannot open or create: No such file or directory");
}

// Writers for series_in_h5py.py, which sets the variable.
const char* folder() {
  return std::getenv("SILT_TEST_FOLDER");
}

const Act write_a_series("write_a_series", [] {
  const std::filesystem::path path = std::filesystem::path(folder()) / "bodies.h5";
  adapters::Provenance provenance;
  provenance.title = "\u00e4";
  {
    auto series = BodySeries::create(MPI_COMM_WORLD, path, info, provenance);
    append(MPI_COMM_WORLD, series, 0, 9);
  }
  auto resumed = BodySeries::open_for_append(MPI_COMM_WORLD, path, 45, info.columns);
  append(MPI_COMM_WORLD, resumed, 5, 9);
});

const Act write_a_series_without_end("write_a_series_without_end", [] {
  const std::filesystem::path path = std::filesystem::path(folder()) / "bodies.h5";
  auto series = std::filesystem::exists(path)
                    ? BodySeries::open_for_append(MPI_COMM_WORLD, path, 1 << 30, info.columns)
                    : BodySeries::create(MPI_COMM_WORLD, path, info, {});
  const int first = static_cast<int>(series.times());
  append(MPI_COMM_WORLD, series, first, 1 << 26);
});

}  // namespace
}  // namespace silt::tests
