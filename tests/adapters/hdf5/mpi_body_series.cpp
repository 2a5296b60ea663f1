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
const adapters::BodySeriesInfo info{.kinds = {{"light", 0.5, 800, {tetrahedron(1)}},
                                              {"heavy \u2605", 0.7, 1200, {tetrahedron(1), tetrahedron(1.5)}},
                                              {"without a mesh", 0.7, 1200, {}}},
                                    .domain_upper = {10, 10, 20},
                                    .columns = {.contacts = true}};

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
      r.load.force[d] = -id * d;
    }
    r.orientation = {1, 0, 0, 1e-3 * step};
    r.mass = 0.5 * id;
    r.contacts = {{0, double(id), 0}, {0, -double(step), 0}};
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
    BodySeries series(comm, scratch / name, info, {});
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
  BodySeries series(MPI_COMM_SELF, scratch / "long.h5", info, {});
  append(MPI_COMM_SELF, series, 0, 99);
  const std::size_t before = mallinfo2().uordblks;
  append(MPI_COMM_SELF, series, 100, 1099);  // 21 rows of 250 bytes each
  EXPECT_LT(mallinfo2().uordblks, before + 500'000);
}

TEST(BodySeries, goes_on_after_the_step_of_a_checkpoint) {
  const Scratch scratch;
  {
    BodySeries series(MPI_COMM_WORLD, scratch / "b.h5", info, {});
    append(MPI_COMM_WORLD, series, 0, 9);
  }
  {
    BodySeries resumed(MPI_COMM_WORLD, scratch / "b.h5", info, {}, 45);
    EXPECT_EQ(resumed.last_step(), rank() == 0 ? 40 : -1);
    append(MPI_COMM_WORLD, resumed, 5, 6);
    EXPECT_EQ(resumed.last_step(), rank() == 0 ? 60 : -1);
  }
  EXPECT_EQ(BodySeries(MPI_COMM_WORLD, scratch / "b.h5", info, {}, -1).last_step(), -1);
}

TEST(BodySeries, has_few_files_and_drops_those_behind_a_checkpoint) {
  const Scratch scratch;
  const auto rows_of = [](std::uint64_t n) {
    std::vector<BodyRow> rows(rank() == 0 ? n : 0);
    for (std::uint64_t i = 0; i < n && rank() == 0; ++i) rows[i].id = i;
    return rows;
  };
  const auto files = [&] {
    const std::size_t n = adapters::body_series_files(scratch / "b.h5").size();
    MPI_Barrier(MPI_COMM_WORLD);
    return n;
  };
  {
    BodySeries series(MPI_COMM_WORLD, scratch / "b.h5", info, {});
    append(series, 0, 0, {});  // a file without rows has no room for any
    append(series, 1, 0, {});
    for (int step = 2; step < 66; ++step) append(series, step, 0, rows_of(1000));
  }
  EXPECT_EQ(files(), 4u);  // of 16 and 32 times, and of more
  EXPECT_TRUE(std::filesystem::exists(scratch / "b_000000000018.h5"));
  BodySeries(MPI_COMM_WORLD, scratch / "b.h5", info, {}, 50);
  EXPECT_EQ(files(), 4u);
  BodySeries(MPI_COMM_WORLD, scratch / "b.h5", info, {}, 49);
  EXPECT_EQ(files(), 3u);
  {
    BodySeries resumed(MPI_COMM_WORLD, scratch / "b.h5", info, {}, 18);
    EXPECT_EQ(resumed.last_step(), rank() == 0 ? 18 : -1);
    for (int step = 19; step < 50; ++step) append(resumed, step, 0, rows_of(1000));
    EXPECT_EQ(files(), 3u);
    append(resumed, 50, 0, rows_of(1000));
  }
  EXPECT_EQ(files(), 4u);
  BodySeries(MPI_COMM_WORLD, scratch / "b.h5", info, {});
  EXPECT_EQ(files(), 0u);
}

TEST(BodySeries, errors_reach_every_rank) {
  const Scratch scratch;
  BodySeries series(MPI_COMM_WORLD, scratch / "b.h5", info, {});
  std::vector<BodyRow> twice(2);
  for (BodyRow& row : twice) row.id = 5;
  EXPECT_TEXT(error_of([&] { append(series, 0, 0, twice); }), "body 5 has two owners in step 0");
  append(series, 3, 0, {});
  EXPECT_TEXT(error_of([&] { append(series, 3, 0, {}); }), "step 3 does not come after step 3");
  EXPECT_TEXT(error_of([&] { BodySeries(MPI_COMM_WORLD, scratch / "b.h5", {}, {}, 9); }),
              "its columns are not those of this run (contact_force)");
  BodySeries nowhere(MPI_COMM_WORLD, scratch / "no" / "b.h5", info, {});
  EXPECT_TEXT(error_of([&] { append(nowhere, 0, 0, {}); }),
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
    BodySeries series(MPI_COMM_WORLD, path, info, provenance);
    append(MPI_COMM_WORLD, series, 0, 9);
  }
  BodySeries resumed(MPI_COMM_WORLD, path, info, provenance, 45);
  append(MPI_COMM_WORLD, resumed, 5, 9);
});

}  // namespace
}  // namespace silt::tests
