#pragma once
// Starts MPI for a program or a module that runs simulations.

namespace silt::coupler {

/// Starts MPI, unless somebody has; returns whether it did. Arguments as of MPI_Init, or none.
bool start_mpi(int* argc = nullptr, char*** argv = nullptr);

}  // namespace silt::coupler
