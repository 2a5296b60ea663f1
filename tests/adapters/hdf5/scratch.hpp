#pragma once
// A scratch folder of its own for each test, the same on all ranks, removed afterwards; and boxes for any
// ranks.
#include <gtest/gtest.h>
#include <mpi.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include "adapters/hdf5/checkpoint_file.hpp"
#include "tests/errors.hpp"
#include "tests/world.hpp"

namespace silt::tests {

class Scratch {
 public:
  Scratch() {
    char name[256] = {};
    if (rank() == 0) {
      const std::string pattern = (std::filesystem::temp_directory_path() / "silt-hdf5-XXXXXX").string();
      pattern.copy(name, sizeof name - 1);
      if (!mkdtemp(name)) name[0] = 0;
    }
    MPI_Bcast(name, sizeof name, MPI_CHAR, 0, MPI_COMM_WORLD);
    folder_ = name;
  }
  ~Scratch() {
    MPI_Barrier(MPI_COMM_WORLD);
    std::error_code ignored;
    if (rank() == 0) std::filesystem::remove_all(folder_, ignored);
    MPI_Barrier(MPI_COMM_WORLD);
  }
  std::filesystem::path operator/(const std::string& name) const { return folder_ / name; }
  const std::filesystem::path& path() const { return folder_; }

 private:
  std::filesystem::path folder_;
};

inline std::string content(const std::filesystem::path& path) {
  std::ifstream in(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

inline std::filesystem::path checkpoint_path(const std::filesystem::path& folder, std::int64_t step) {
  return adapters::step_path(folder, "checkpoint", step, ".h5");
}

/// Returns what wrote a file, with the text of a case and a number of ranks.
inline adapters::Provenance made_from(const std::string& case_text, int ranks = 1) {
  adapters::Provenance provenance;
  provenance.version = "0.1.0", provenance.commit = "abc";
  provenance.title = "a title", provenance.case_text = case_text;
  provenance.ranks = ranks;
  provenance.backend = "auto", provenance.compiler = "g++";
  return provenance;
}

/// Cuts a lattice into blocks of the given size and deals them to `ranks`: in turn, or in runs; the last rank
/// of several is left without any when `leave_one_idle`.
inline std::vector<adapters::CellBox> blocks_of(int rank, int ranks, std::array<int, 3> cells,
                                                std::array<int, 3> block, bool in_turn = true,
                                                bool leave_one_idle = false) {
  if (leave_one_idle && ranks > 1) --ranks;
  std::vector<adapters::CellBox> all, mine;
  for (int z = 0; z < cells[2]; z += block[2])
    for (int y = 0; y < cells[1]; y += block[1])
      for (int x = 0; x < cells[0]; x += block[0])
        all.push_back({{x, y, z},
                       {std::min(block[0], cells[0] - x), std::min(block[1], cells[1] - y),
                        std::min(block[2], cells[2] - z)}});
  const int n = static_cast<int>(all.size());
  for (int i = 0; i < n; ++i)
    if ((in_turn ? i % ranks : i * ranks / n) == rank) mine.push_back(all[i]);
  return mine;
}

/// Bodies with their impulses, for a checkpoint.
struct BodyList {
  std::vector<rigid::BodyRecord> records;
  std::vector<std::vector<rigid::StoredImpulse>> impulses;

  adapters::OwnedRows rows() const {
    return {records.size(), [this](std::size_t i) { return records[i]; },
            [this](std::size_t i) -> const std::vector<rigid::StoredImpulse>& { return impulses[i]; }};
  }
};

/// Calls f(x, y, z, i) for every cell of a box, i counting them with x fastest.
template <class F>
void for_each_cell(const adapters::CellBox& box, F&& f) {
  std::size_t i = 0;
  for_cells(box.lower, box.lower + box.size, [&](lbm::Int3 x) { f(x.x, x.y, x.z, i++); });
}

}  // namespace silt::tests
