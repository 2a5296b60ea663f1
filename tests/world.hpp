#pragma once
// The ranks of a test, and what they find together.
#include <mpi.h>

#include <cstdint>

namespace silt::tests {

inline int rank() {
  int r = 0;
  MPI_Comm_rank(MPI_COMM_WORLD, &r);
  return r;
}
inline int ranks() {
  int n = 1;
  MPI_Comm_size(MPI_COMM_WORLD, &n);
  return n;
}
inline double sum_over_ranks(double x) {
  double all = 0;
  MPI_Allreduce(&x, &all, 1, MPI_DOUBLE, MPI_SUM, MPI_COMM_WORLD);
  return all;
}
inline double largest_of_ranks(double x) {
  double all = 0;
  MPI_Allreduce(&x, &all, 1, MPI_DOUBLE, MPI_MAX, MPI_COMM_WORLD);
  return all;
}
/// Returns on every rank what rank 0 finds on its own.
template <class Work>
std::uint64_t alone(Work&& work) {
  std::uint64_t found = 0;
  if (rank() == 0) found = work();
  MPI_Bcast(&found, 1, MPI_UINT64_T, 0, MPI_COMM_WORLD);
  return found;
}

}  // namespace silt::tests
