// The bodies of a checkpoint: each once, in one order, the same file from any number of ranks.
#include "tests/adapters/hdf5/checkpoint_content.hpp"

namespace silt::tests {
namespace {

TEST(Checkpoint, an_owner_too_many_is_an_error) {
  const Scratch scratch;
  const auto error = [&](const BodyList& owned) {
    CheckpointWriter writer(MPI_COMM_WORLD, checkpoint_path(scratch.path(), 1), {});
    return error_of([&] { writer.bodies(owned.rows()); });
  };
  EXPECT_TEXT(error({std::vector<BodyRecord>(2, record(7)), {{}, {}}}), "body 7 has two owners");
  // on the first and the last rank, among many: the least is named
  BodyList owned;
  for (int i = 0; i < 100; ++i) owned.records.push_back(record(1 + 100 * rank() + i));
  for (const int id : {90, 60})
    if (rank() == ranks() - 1) owned.records.push_back(record(id));
  owned.impulses.resize(owned.records.size());
  EXPECT_TEXT(error(owned), "body 60 has two owners");
}

/// Ids that leave gaps, one of them far from all others, on any number of ranks; a rank without any.
TEST(Checkpoint, is_the_same_file_from_any_number_of_ranks) {
  const Scratch scratch;
  const auto write_all = [&](MPI_Comm comm, const char* name) {
    int r = 0, n = 1;
    MPI_Comm_rank(comm, &r);
    MPI_Comm_size(comm, &n);
    BodyList owned;
    for (std::uint64_t k = 0; k < 1000; ++k) {
      const std::uint64_t id =
          k == 999 ? std::uint64_t{1} << 40 : 5 + k * k % 997 + 1000 * (k % 7) + 10000 * k;
      if (int(id % (n > 2 ? n - 1 : n)) != r) continue;
      owned.records.push_back(record(id));
      owned.impulses.push_back(impulses(id));
    }
    const std::vector<CellBox> boxes = blocks_of(r, n, cells, {4, 6, 5});
    CheckpointWriter writer(comm, scratch / name,
                            {"0.1.0", "abc", "t", "text", 3, "auto", "g++", "host", "now"});
    writer.set("step", std::int64_t{7});
    write_populations<float>(writer, boxes);
    writer.bodies(owned.rows(), kept_columns);
    writer.commit(0);
    usleep(1100000);  // the time of day must not be in it either
  };
  write_all(MPI_COMM_WORLD, "many.h5");
  if (rank() == 0) {
    write_all(MPI_COMM_SELF, "one.h5");
    EXPECT_GT(content(scratch / "one.h5").size(), 1000u * 400);
    EXPECT_TRUE(content(scratch / "one.h5") == content(scratch / "many.h5"));
  }
}

TEST(Checkpoint, of_no_bodies) {
  const Scratch scratch;
  const auto path = scratch / "none.h5";
  {
    CheckpointWriter writer(MPI_COMM_WORLD, path, {});
    const BodyList none;
    writer.bodies(none.rows());
    writer.commit(0);
  }
  const CheckpointReader reader(MPI_COMM_WORLD, path);
  EXPECT_TRUE(reader.bodies().records.empty());
}

}  // namespace
}  // namespace silt::tests
