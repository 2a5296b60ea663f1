#pragma once
#include <mpi.h>

#include <chrono>
#include <thread>

namespace silt::bench {

/// A barrier for timed runs that leaves the processor to the ranks that still work.
inline void wait_asleep() {
  MPI_Request request;
  MPI_Ibarrier(MPI_COMM_WORLD, &request);
  for (int done = 0; !done; MPI_Test(&request, &done, MPI_STATUS_IGNORE))
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
}

}  // namespace silt::bench
