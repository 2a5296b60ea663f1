#include "coupler/run/start_mpi.hpp"

#include <mpi.h>

#include <cstdlib>

namespace silt::coupler {

bool start_mpi(int* argc, char*** argv) {
  int started = 0;
  MPI_Initialized(&started);
  if (started) return false;
  // Open MPI's usual component for shared file pointers, which nothing here uses, overflows with paths above
  // 240 bytes.
  setenv("OMPI_MCA_sharedfp", "individual", 0);
  MPI_Init(argc, argv);
  return true;
}

}  // namespace silt::coupler
