// A full disk (here: a limit on the size of files, which the system reports in the same way) and the end of
// the memory are told to every rank with the file's name, also where only one rank meets them, and cost
// nothing that was there before. And no single damaged byte goes unnoticed.
#include <malloc.h>
#include <sys/resource.h>

#include <csignal>
#include <optional>

#include "adapters/hdf5/body_series.hpp"
#include "adapters/hdf5/checkpoint_file.hpp"
#include "adapters/hdf5/field_file.hpp"
#include "tests/adapters/hdf5/scratch.hpp"

namespace silt::tests {
namespace {

using adapters::CellBox;

/// While it lives, no file of this process may grow beyond `bytes`.
class FullDisk {
 public:
  explicit FullDisk(rlim_t bytes) {
    handler_ = std::signal(SIGXFSZ, SIG_IGN);
    getrlimit(RLIMIT_FSIZE, &before_);
    const rlimit now{bytes, before_.rlim_max};
    setrlimit(RLIMIT_FSIZE, &now);
  }
  ~FullDisk() {
    setrlimit(RLIMIT_FSIZE, &before_);
    std::signal(SIGXFSZ, handler_);
  }

 private:
  rlimit before_;
  void (*handler_)(int);
};

/// While it lives, this process gets hardly more memory than it has: two megabytes, for MPI.
class NoMemory {
 public:
  NoMemory() {
    mallopt(M_MMAP_THRESHOLD, 1 << 20);  // what was freed is of no use for more than that
    malloc_trim(0);
    std::ifstream size("/proc/self/statm");
    rlim_t pages = 0;
    size >> pages;
    getrlimit(RLIMIT_AS, &before_);
    const rlimit now{pages * rlim_t(sysconf(_SC_PAGESIZE)) + (2 << 20), before_.rlim_max};
    setrlimit(RLIMIT_AS, &now);
  }
  ~NoMemory() { setrlimit(RLIMIT_AS, &before_); }

 private:
  rlimit before_;
};

constexpr std::array<int, 3> cells{32, 16, 16};

const std::vector<rigid::StoredImpulse> impulses(20, {7, {1, 0, -1}, 3, rigid::Vec3(1, 2, 3)});

bool same_impulse(const rigid::StoredImpulse& a, const rigid::StoredImpulse& b) {
  return a.partner == b.partner && a.image == b.image && a.feature == b.feature && a.impulse == b.impulse;
}

void write_checkpoint(MPI_Comm comm, const std::filesystem::path& path, const std::vector<CellBox>& boxes,
                      std::array<int, 3> lattice = cells) {
  adapters::CheckpointWriter writer(comm, path, made_from("text\n"));
  writer.set("step", std::int64_t{77});
  writer.set("label", "some text");
  writer.cells("populations", adapters::Storage::single, lattice, 19, boxes,
               [&](int q, std::size_t box, void* to) {
                 auto* const out = static_cast<float*>(to);
                 for_each_cell(boxes[box], [&](int x, int y, int z, std::size_t i) {
                   out[i] = 0.5f + q + 0.1f * x - 0.01f * y + 0.001f * z;
                 });
               });
  int rank = 0;
  MPI_Comm_rank(comm, &rank);
  BodyList owned{std::vector<rigid::BodyRecord>(2), {{}, {}}};
  for (int i = 0; i < 2; ++i) owned.records[i].id = 2 * rank + i;
  owned.impulses[1] = impulses;
  writer.bodies(owned.rows());
  writer.commit(1);
}

TEST(FullDisk, leaves_the_previous_checkpoint) {
  const Scratch scratch;
  const auto first = checkpoint_path(scratch.path(), 1), second = checkpoint_path(scratch.path(), 2);
  const auto boxes = blocks_of(rank(), ranks(), cells, {16, 16, 16});
  write_checkpoint(MPI_COMM_WORLD, first, boxes);
  for (const rlim_t limit : {rlim_t{100}, rlim_t{300000}, rlim_t{19 * 4 * 32 * 16 * 16}}) {
    std::string error;
    {
      const FullDisk full(limit);
      error = error_of([&] { write_checkpoint(MPI_COMM_WORLD, second, boxes); });
    }
    EXPECT_TEXT(error, second.string() + ".part: cannot");
    EXPECT_TEXT(error, "disk full");
    MPI_Barrier(MPI_COMM_WORLD);
    EXPECT_FALSE(std::filesystem::exists(second) || std::filesystem::exists(second.string() + ".part"));
    EXPECT_EQ(adapters::CheckpointReader(MPI_COMM_WORLD, first).integer("step"), 77);
  }
  write_checkpoint(MPI_COMM_WORLD, second, boxes);  // once there is room again
  EXPECT_EQ(adapters::list_checkpoints(scratch.path()).size(), 1u);
}

TEST(FullDisk, of_one_rank_is_told_to_all) {
  const Scratch scratch;
  const auto first = checkpoint_path(scratch.path(), 1), second = checkpoint_path(scratch.path(), 2);
  const auto boxes = blocks_of(rank(), ranks(), cells, {16, 16, 16});
  write_checkpoint(MPI_COMM_WORLD, first, boxes);
  for (int failing = 0; failing < ranks(); ++failing) {
    std::string error;
    {
      std::optional<FullDisk> full;
      if (rank() == failing) full.emplace(100000);
      error = error_of([&] { write_checkpoint(MPI_COMM_WORLD, second, boxes); });
    }
    EXPECT_TEXT(error, second.string() + ".part: cannot");
    EXPECT_TEXT(error, "ulimit -f");
    MPI_Barrier(MPI_COMM_WORLD);
    EXPECT_FALSE(std::filesystem::exists(second) || std::filesystem::exists(second.string() + ".part"));
    EXPECT_EQ(adapters::CheckpointReader(MPI_COMM_WORLD, first).integer("step"), 77);
  }
}

/// Four million values.
TEST(NoMemory, of_one_rank_is_told_to_all) {
  const Scratch scratch;
  constexpr std::array<int, 3> many{256, 256, 64};
  const auto boxes = blocks_of(rank(), ranks(), many, {64, 64, 64});
  const auto fill = [&](std::size_t b, int first, int last, double* out) {
    std::fill_n(out, boxes[b].cells() / 64 * (last - first), 1.25);
  };
  for (int failing = 0; failing < ranks(); ++failing) {
    const auto path = scratch / "fields_1.hdf";
    std::string error;
    {
      std::optional<NoMemory> none;
      if (rank() == failing) none.emplace();
      error = error_of([&] {
        adapters::write_fields(MPI_COMM_WORLD, path, boxes,
                               {{many}, {{"density", "", 1, fill, adapters::Storage::double_}}, 0, 1}, {});
      });
    }
    EXPECT_TEXT(error, "no memory is left");
    EXPECT_TEXT(error, "ulimit -v");
    MPI_Barrier(MPI_COMM_WORLD);
    EXPECT_FALSE(std::filesystem::exists(path) || std::filesystem::exists(path.string() + ".part"));
    MPI_Barrier(MPI_COMM_WORLD);
  }
}

TEST(FullDisk, is_told_of_a_field_file) {
  const Scratch scratch;
  const auto boxes = blocks_of(rank(), ranks(), cells, {16, 16, 16});
  const auto fill = [&](std::size_t b, int first, int last, double* out) {
    const auto& size = boxes[b].size;
    std::fill_n(out, size.x * size.y * (last - first), 1.25);
  };
  const auto write = [&] {
    adapters::write_fields(MPI_COMM_WORLD, scratch / "fields_1.hdf", boxes,
                           {{cells}, {{"density", "", 1, fill}}, 0, 1}, {});
  };
  for (const rlim_t limit : {100, 20000}) {
    std::string error;
    {
      const FullDisk full(limit);
      error = error_of(write);
    }
    EXPECT_TEXT(error, "fields_1.hdf.part: cannot");
    MPI_Barrier(MPI_COMM_WORLD);
    EXPECT_TRUE(std::filesystem::is_empty(scratch.path()));
    MPI_Barrier(MPI_COMM_WORLD);
  }
  EXPECT_EQ(error_of(write), "");
}

TEST(FullDisk, leaves_a_series_that_goes_on_when_there_is_room) {
  const Scratch scratch;
  adapters::BodySeries series(MPI_COMM_WORLD, scratch / "bodies.h5", {}, {});
  const auto append = [&](adapters::BodySeries& to, int step) {
    to.append(step, 0, 100, [](std::size_t i) {
      adapters::BodyRow row{};
      row.id = 100 * rank() + i;
      return row;
    });
  };
  int step = 0;
  std::string error;
  {
    const FullDisk full(1500000 * ranks());
    while (error.empty() && step < 1000) error = error_of([&] { append(series, step++); });
  }
  EXPECT_TEXT(error, ".h5.part: cannot");
  const int whole = step - 1;
  EXPECT_GT(whole, 10);
  adapters::BodySeries resumed(MPI_COMM_WORLD, scratch / "bodies.h5", {}, {}, 1000);
  EXPECT_EQ(resumed.last_step(), rank() == 0 ? whole - 1 : -1);
  append(resumed, step);
}

/// Returns whether a checkpoint says what write_checkpoint wrote.
bool is_whole(const adapters::CheckpointReader& reader, const CellBox& box) {
  std::size_t wrong = 0;
  reader.cells("populations", adapters::Storage::single, {box}, [&](int q, std::size_t, const void* from) {
    const auto* const in = static_cast<const float*>(from);
    for_each_cell(box, [&](int x, int y, int z, std::size_t i) {
      wrong += in[i] != 0.5f + q + 0.1f * x - 0.01f * y + 0.001f * z;
    });
  });
  const auto bodies = reader.bodies();
  return wrong == 0 && reader.integer("step") == 77 && reader.text("label") == "some text" &&
         reader.case_text() == "text\n" && bodies.records.size() == 2 && bodies.records[1].id == 1 &&
         bodies.records[1].mass == 1 && bodies.impulses[0].empty() &&
         std::equal(impulses.begin(), impulses.end(), bodies.impulses[1].begin(), bodies.impulses[1].end(),
                    same_impulse);
}

/// A checkpoint of which each rank damages its share, in a folder of its own.
class Damage : public ::testing::Test {
 protected:
  Damage() {
    std::filesystem::create_directory(mine);
    write_checkpoint(MPI_COMM_SELF, path, {box}, {3, 2, 2});
    good = content(path);
  }

  const Scratch scratch;
  const std::filesystem::path mine = scratch / std::to_string(rank());
  const CellBox box{{0, 0, 0}, {3, 2, 2}};
  const std::filesystem::path path = checkpoint_path(mine, 1), copy = mine / "checkpoint_2.h5";
  std::string good;
};

TEST_F(Damage, of_a_single_byte_is_found_or_harmless) {
  std::size_t found = 0, harmless = 0;
  for (std::size_t at = 23 * rank(); at < good.size(); at += 23 * ranks()) {
    std::string bad = good;
    bad[at] ^= static_cast<char>(1 << (at % 8));
    std::ofstream(copy, std::ios::binary) << bad;
    const std::string error = error_of([&] {
      const adapters::CheckpointReader reader(MPI_COMM_SELF, copy);
      if (!is_whole(reader, box)) ADD_FAILURE() << "damage at byte " << at << " went unnoticed";
    });
    error.empty() ? ++harmless : ++found;
    if (!error.empty()) {
      EXPECT_TEXT(error, "use the previous checkpoint, " + path.string());
    }
  }
  std::printf("%zu damaged bytes: %zu found, %zu in unused space\n", found + harmless, found, harmless);
  EXPECT_GT(found, 0u);
}

TEST_F(Damage, of_a_cut_file_is_found) {
  for (std::size_t size = 97 * rank(); size < good.size(); size += 97 * ranks()) {
    std::ofstream(copy, std::ios::binary) << good.substr(0, size);
    EXPECT_NE(error_of([&] { adapters::CheckpointReader reader(MPI_COMM_SELF, copy); }), "")
        << size << " bytes left";
  }
}

}  // namespace
}  // namespace silt::tests
