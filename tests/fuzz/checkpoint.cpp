// The reader of checkpoints, and what describes files: anything but std::runtime_error is a fault.
#include <mpi.h>
#include <unistd.h>

#include <cstdint>
#include <filesystem>
#include <fstream>
#include <stdexcept>

#include "adapters/hdf5/checkpoint_file.hpp"
#include "silt/case/case.hpp"
#include "silt/case/case_file.hpp"
#include "silt/results/checkpoint.hpp"

namespace {

template <class Read>
void attempt(Read&& read) {
  try {
    read();
  } catch (const std::runtime_error&) {
  }
}

void resume_from(const std::filesystem::path& path) {
  using namespace silt;
  const adapters::CheckpointReader reader(MPI_COMM_SELF, path);
  const CaseOrigin origin = read_origin(reader);
  CaseSource source{"seeds/case.toml", origin.text, {}};
  const Case scene = read_case(source);
  read_state(reader, scene);
  read_history(reader, scene);
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* bytes, std::size_t size) {
  static const bool started = [] { return MPI_Init(nullptr, nullptr) == MPI_SUCCESS; }();
  if (!started) return 0;
  static const auto path =
      std::filesystem::temp_directory_path() / ("silt-fuzz-" + std::to_string(getpid()) + ".h5");
  std::ofstream(path, std::ios::binary).write(reinterpret_cast<const char*>(bytes), std::streamsize(size));
  attempt([&] { resume_from(path); });
  std::filesystem::remove(path);
  return 0;
}
