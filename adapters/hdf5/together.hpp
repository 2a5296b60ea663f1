#pragma once
// Errors that all ranks see alike.
#include <mpi.h>

#include <exception>
#include <string>
#include <utility>

namespace silt::adapters {

/// Collective. Throws std::runtime_error with the text of the lowest rank that hands one over, on every rank.
/// `failed` with an empty text counts as an error too.
void throw_together(MPI_Comm, bool failed, const std::string& error);

/// Collective: runs `work` on this rank; if it threw on any rank, every rank throws the error of the lowest
/// such rank as std::runtime_error. `work` must not throw between two collective calls of its own.
template <class Work>
void together(MPI_Comm comm, Work&& work) {
  bool failed = false;
  std::string error;
  try {
    std::forward<Work>(work)();
  } catch (const std::exception& e) {
    failed = true;
    error = e.what();
  }
  throw_together(comm, failed, error);
}

/// Does as `together` for work that only rank 0 does.
template <class Work>
void on_rank_0(MPI_Comm comm, Work&& work) {
  int rank = 0;
  MPI_Comm_rank(comm, &rank);
  together(comm, [&] {
    if (rank == 0) work();
  });
}

}  // namespace silt::adapters
