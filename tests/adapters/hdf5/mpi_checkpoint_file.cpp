// A checkpoint comes back to the bit, on any layout, its bodies each once and in one order; damage of any
// kind is found and said.
#include "adapters/hdf5/checkpoint_file.hpp"
#include "tests/adapters/hdf5/checkpoint_content.hpp"

namespace silt::tests {
namespace {

struct Layout {
  MPI_Comm comm = MPI_COMM_WORLD;
  std::array<int, 3> block{4, 6, 5};
  bool in_turn = true, idle = false;

  std::vector<CellBox> boxes() const {
    int r = 0, n = 1;
    MPI_Comm_rank(comm, &r);
    MPI_Comm_size(comm, &n);
    return blocks_of(r, n, cells, block, in_turn, idle);
  }
};

const std::string case_text = "title = \"\u00e4\"\n" + std::string(100000, '#');

template <class T>
void write(const Layout& layout, const std::filesystem::path& path, int keep = 0) {
  CheckpointWriter writer(layout.comm, path, tests::made_from(case_text, 3));
  writer.set("step", std::int64_t{1} << 60);
  writer.set("time", 0.1);
  writer.set("backend", "analytic");
  const auto boxes = layout.boxes();
  write_populations<T>(writer, boxes);
  writer.cells("flags", adapters::Storage::byte, cells, 1, boxes, [&](int, std::size_t box, void* out) {
    for_each_cell(boxes[box], [&](int x, int y, int z, std::size_t i) {
      static_cast<std::uint8_t*>(out)[i] = flag(x, y, z);
    });
  });
  int r = 0, n = 1;
  MPI_Comm_rank(layout.comm, &r);
  MPI_Comm_size(layout.comm, &n);
  BodyList owned;
  for (int id = bodies_in_all - r; id > 0; id -= n) {
    owned.records.push_back(record(id));
    owned.impulses.push_back(impulses(id));
  }
  writer.bodies(owned.rows(), kept_columns);
  writer.commit(keep);
}

template <class T>
void expect_whole(const Layout& layout, const std::filesystem::path& path) {
  const CheckpointReader reader(layout.comm, path);
  EXPECT_EQ(reader.integer("step"), std::int64_t{1} << 60);
  EXPECT_EQ(reader.number("time"), 0.1);
  EXPECT_EQ(reader.text("backend"), "analytic");
  EXPECT_TRUE(reader.has("step") && !reader.has("stop"));
  EXPECT_EQ(reader.case_text(), case_text);
  EXPECT_EQ(reader.provenance("compiler"), "g++");
  EXPECT_EQ(reader.lattice("populations"), cells);
  EXPECT_EQ(reader.components("populations"), populations);
  const auto boxes = layout.boxes();
  EXPECT_EQ(wrong_populations<T>(reader, boxes), 0u);
  std::size_t wrong = 0;
  reader.cells("flags", adapters::Storage::byte, boxes, [&](int, std::size_t box, const void* in) {
    for_each_cell(boxes[box], [&](int x, int y, int z, std::size_t i) {
      wrong += static_cast<const std::uint8_t*>(in)[i] != flag(x, y, z);
    });
  });
  EXPECT_EQ(wrong, 0u);
  const auto found = reader.bodies(kept_columns);
  int r = 0, n = 1;
  MPI_Comm_rank(layout.comm, &r);
  MPI_Comm_size(layout.comm, &n);
  const std::size_t first = bodies_in_all * r / n;
  ASSERT_EQ(found.records.size(), std::size_t(bodies_in_all * (r + 1) / n) - first);
  for (std::size_t i = 0; i < found.records.size(); ++i) {
    const std::uint64_t id = first + i + 1;
    expect_equal(found.records[i], record(id));
    const auto expected = impulses(id);
    ASSERT_EQ(found.impulses[i].size(), expected.size());
    for (std::size_t j = 0; j < expected.size(); ++j) {
      EXPECT_EQ(found.impulses[i][j].partner, expected[j].partner);
      EXPECT_TRUE(found.impulses[i][j].image == expected[j].image);
      EXPECT_EQ(found.impulses[i][j].feature, expected[j].feature);
      EXPECT_EQ(0, std::memcmp(found.impulses[i][j].impulse.data(), expected[j].impulse.data(),
                               3 * sizeof(double)));
    }
  }
}

template <class T>
void round_trip() {
  const Scratch scratch;
  const auto path = checkpoint_path(scratch.path(), 5000);
  for (const Layout& writer : {Layout{}, Layout{MPI_COMM_WORLD, {11, 1, 2}, false, true}}) {
    write<T>(writer, path);
    for (const Layout& reader :
         {Layout{}, Layout{MPI_COMM_WORLD, {3, 4, 9}, true, true}, Layout{MPI_COMM_WORLD, {11, 6, 9}}})
      expect_whole<T>(reader, path);
    if (rank() == 0) expect_whole<T>({MPI_COMM_SELF}, path);  // what n ranks wrote, one rank reads
    MPI_Barrier(MPI_COMM_WORLD);
  }
  if (rank() == 0) write<T>({MPI_COMM_SELF}, path);  // and the reverse
  MPI_Barrier(MPI_COMM_WORLD);
  expect_whole<T>({}, path);
}

TEST(Checkpoint, comes_back_to_the_bit_in_single_precision) {
  round_trip<float>();
}
TEST(Checkpoint, comes_back_to_the_bit_in_double_precision) {
  round_trip<double>();
}

TEST(Checkpoint, of_a_lattice_with_fewer_planes_than_ranks) {
  const Scratch scratch;
  const std::array<int, 3> thin{6, 5, 3};
  const auto path = checkpoint_path(scratch.path(), 1);
  const auto boxes = blocks_of(rank(), ranks(), thin, {2, 2, 2});
  const auto number = [](int q, int x, int y, int z) {
    return std::uint8_t(q * 90 + z * 30 + y * 6 + x + 1);
  };
  {
    CheckpointWriter writer(MPI_COMM_WORLD, path, {});
    writer.cells("n", adapters::Storage::byte, thin, 2, boxes, [&](int q, std::size_t box, void* out) {
      for_each_cell(boxes[box], [&](int x, int y, int z, std::size_t i) {
        static_cast<std::uint8_t*>(out)[i] = number(q, x, y, z);
      });
    });
    writer.commit(0);
  }
  const CheckpointReader reader(MPI_COMM_WORLD, path);
  const CellBox box{{1, 0, 1}, {4, 4, 2}};  // the same on every rank: readers may overlap
  std::size_t wrong = 0, calls = 0;
  reader.cells("n", adapters::Storage::byte, {box}, [&](int q, std::size_t, const void* in) {
    ++calls;
    for_each_cell(box, [&](int x, int y, int z, std::size_t i) {
      wrong += static_cast<const std::uint8_t*>(in)[i] != number(q, x, y, z);
    });
  });
  EXPECT_EQ(calls, 2u);
  EXPECT_EQ(wrong, 0u);
}

TEST(Checkpoint, keeps_the_newest_and_removes_unfinished_ones) {
  const Scratch scratch;
  if (rank() == 0) std::ofstream(checkpoint_path(scratch.path(), 150).string() + ".part") << "cut off";
  for (const int step : {100, 200, 300, 400}) write<float>({}, checkpoint_path(scratch.path(), step), 2);
  const auto left = adapters::list_checkpoints(scratch.path());
  ASSERT_EQ(left.size(), 2u);
  EXPECT_EQ(left[0].step, 400);
  EXPECT_EQ(left[1].step, 300);
  EXPECT_EQ(std::distance(std::filesystem::directory_iterator(scratch.path()), {}), 2);
}

TEST(Checkpoint, nothing_is_left_without_commit) {
  const Scratch scratch;
  {
    CheckpointWriter writer(MPI_COMM_WORLD, checkpoint_path(scratch.path(), 1), {});
    write_populations<float>(writer, Layout{}.boxes());
  }
  MPI_Barrier(MPI_COMM_WORLD);
  EXPECT_TRUE(std::filesystem::is_empty(scratch.path()));
}

std::string reading_error(const std::filesystem::path& path) {
  return error_of([&] { CheckpointReader reader(MPI_COMM_WORLD, path); });
}

void alter(const std::filesystem::path& path, std::size_t at) {
  MPI_Barrier(MPI_COMM_WORLD);
  if (rank() == 0) {
    std::fstream file(path, std::ios::binary | std::ios::in | std::ios::out);
    file.seekg(at);
    const char c = static_cast<char>(file.get() ^ 0x10);
    file.seekp(at);
    file.put(c);
  }
  MPI_Barrier(MPI_COMM_WORLD);
}

TEST(Checkpoint, damage_is_named_with_what_to_do) {
  const Scratch scratch;
  const auto old = checkpoint_path(scratch.path(), 100), path = checkpoint_path(scratch.path(), 200);
  write<float>({}, old);
  write<float>({}, path);
  const std::string advice = "use the previous checkpoint, " + old.string();

  const std::size_t size = std::filesystem::file_size(path);
  const auto bits = bits_of<float>(5, 5, 5, 5);  // a population's place in the file
  const std::size_t place =
      content(path).find(std::string(reinterpret_cast<const char*>(&bits), sizeof bits));
  ASSERT_NE(place, std::string::npos);
  alter(path, place);
  std::string error = reading_error(path);
  EXPECT_TEXT(error,
              path.string() + ": the content of /cells/populations does not match its checksum (altered)");
  EXPECT_TEXT(error, advice);
  alter(path, place);
  EXPECT_EQ(reading_error(path), "");

  if (rank() == 0) std::filesystem::resize_file(path, size - 1000);
  MPI_Barrier(MPI_COMM_WORLD);
  error = reading_error(path);
  EXPECT_TEXT(error, path.string() + ": cannot open the file as HDF5 (missing, truncated or altered)");
  EXPECT_TEXT(error, advice);

  if (rank() == 0) std::filesystem::resize_file(path, 0);
  MPI_Barrier(MPI_COMM_WORLD);
  EXPECT_TEXT(reading_error(path), advice);

  MPI_Barrier(MPI_COMM_WORLD);
  if (rank() == 0) std::filesystem::remove(path);
  MPI_Barrier(MPI_COMM_WORLD);
  EXPECT_TEXT(reading_error(path), "there is no such file");
  EXPECT_TEXT(reading_error(path), advice);
  if (rank() == 0) std::filesystem::remove(old);
  MPI_Barrier(MPI_COMM_WORLD);
  EXPECT_TEXT(reading_error(path), "there is no earlier checkpoint next to it, start the case again");
}

TEST(Checkpoint, asks_for_the_precision_it_was_written_in) {
  const Scratch scratch;
  const auto path = checkpoint_path(scratch.path(), 1);
  write<float>({}, path);
  const CheckpointReader reader(MPI_COMM_WORLD, path);
  EXPECT_TEXT(error_of([&] { wrong_populations<double>(reader, Layout{}.boxes()); }), "another precision");
  EXPECT_TEXT(error_of([&] { reader.integer("stop"); }), "has no attribute stop");
}

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
    CheckpointWriter writer(comm, scratch / name, tests::made_from("text", 3));
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
