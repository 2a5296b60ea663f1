#include "coupler/run/reunion.hpp"

#include <chrono>
#include <thread>

namespace silt::coupler {

Reunion::Reunion(MPI_Comm comm) {
  MPI_Comm_dup(comm, &comm_);
}

Reunion::~Reunion() {
  MPI_Comm_free(&comm_);
}

bool Reunion::all_here() {
  const double end = MPI_Wtime() + patience;
  MPI_Request barrier = MPI_REQUEST_NULL;
  MPI_Ibarrier(comm_, &barrier);
  for (int done = 0; MPI_Wtime() < end;) {
    MPI_Test(&barrier, &done, MPI_STATUS_IGNORE);
    if (done) return true;
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
  return false;
}

}  // namespace silt::coupler
