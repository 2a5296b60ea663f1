#pragma once
// What the benchmarks' programs begin and end with.
#include <mpi.h>
#include <chrono>
#include <cstdio>
#include <exception>
#include <thread>

#include "cpu/isa.hpp"
#include "silt/run/run.hpp"
#include "tests/bench/figures.hpp"

namespace silt::bench {

/// A barrier for timed runs that leaves the processor to the ranks that still work.
inline void wait_asleep() {
  MPI_Request request;
  MPI_Ibarrier(MPI_COMM_WORLD, &request);
  for (int done = 0; !done; MPI_Test(&request, &done, MPI_STATUS_IGNORE))
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
}

/// main() of a benchmark: run(options) with MPI up, numbers treated as in production, lines shown as they
/// come. What it throws is said, and the exit code is then 2 (on several ranks for all of them).
template <class Run>
int main_of(int argc, char** argv, Run&& run) {
  start_mpi(&argc, &argv);
  setvbuf(stdout, nullptr, _IOLBF, 0);
  flush_denormals_to_zero();
  try {
    run(options_of(argc, argv));
  } catch (const std::exception& e) {
    fprintf(stderr, "%s\n", e.what());
    MPI_Abort(MPI_COMM_WORLD, 2);
  }
  MPI_Finalize();
  return 0;
}

}  // namespace silt::bench
