// benchmarks NAME [--quick] [--json FILE] [other options of the benchmark]: runs one of them.
#include <mpi.h>

#include <cstdio>
#include <exception>
#include <string_view>

#include "cpu/isa.hpp"
#include "silt/run/run.hpp"
#include "tests/bench/figures.hpp"

namespace silt::bench {

#define SILT_BENCHMARKS(use)                                                                       \
  use(bed) use(broad_phase) use(close_range) use(collision_pairs) use(coupled) use(dry) use(fluid) \
      use(instructions) use(levels) use(links) use(memory) use(mesh_pairs) use(scaling) use(skip) use(walls)
#define SILT_DECLARE(name)  \
  namespace name {          \
  void run(const Options&); \
  }
#define SILT_LIST(name) {#name, name::run},

SILT_BENCHMARKS(SILT_DECLARE)
constexpr struct {
  std::string_view name;
  void (*run)(const Options&);
} benchmarks[] = {SILT_BENCHMARKS(SILT_LIST)};

void run(std::string_view name, const Options& options) {
  for (const auto& benchmark : benchmarks)
    if (benchmark.name == name) return benchmark.run(options);
  std::string known;
  for (const auto& benchmark : benchmarks) known.append(" ").append(benchmark.name);
  throw std::invalid_argument("usage: benchmarks NAME [options]; known:" + known);
}

}  // namespace silt::bench

/// MPI is up, numbers are treated as in production, lines are shown as they come. What a benchmark throws is
/// said, and the exit code is then 2 (on several ranks for all of them).
int main(int argc, char** argv) {
  using namespace silt;
  start_mpi(&argc, &argv);
  setvbuf(stdout, nullptr, _IOLBF, 0);
  flush_denormals_to_zero();
  try {
    bench::run(argc > 1 ? argv[1] : "", bench::options_of(argc - 1, argv + 1));
  } catch (const std::exception& e) {
    fprintf(stderr, "%s\n", e.what());
    MPI_Abort(MPI_COMM_WORLD, 2);
  }
  MPI_Finalize();
  return 0;
}
