#pragma once
// The number of ranks, the number of this rank, and duplicated communicators.
#include <mpi.h>

namespace silt::parallel {

inline int rank_of(MPI_Comm comm) {
  int rank = 0;
  MPI_Comm_rank(comm, &rank);
  return rank;
}
inline int ranks_of(MPI_Comm comm) {
  int ranks = 1;
  MPI_Comm_size(comm, &ranks);
  return ranks;
}

/// A duplicate of a communicator, whose messages cannot be mistaken for others.
class OwnCommunicator {
 public:
  explicit OwnCommunicator(MPI_Comm comm) { MPI_Comm_dup(comm, &comm_); }  // collective
  ~OwnCommunicator() {
    int finalized = 0;
    MPI_Finalized(&finalized);
    if (!finalized) MPI_Comm_free(&comm_);
  }
  OwnCommunicator(const OwnCommunicator&) = delete;
  OwnCommunicator& operator=(const OwnCommunicator&) = delete;
  operator MPI_Comm() const { return comm_; }

 private:
  MPI_Comm comm_ = MPI_COMM_NULL;
};

}  // namespace silt::parallel
