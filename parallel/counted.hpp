#pragma once
// Private to parallel/: wrappers of MPI calls that count them (traffic.hpp).
#include <mpi.h>

#include "parallel/communicator.hpp"
#include "parallel/traffic.hpp"

namespace silt::parallel::counting {

inline void count_message(std::size_t bytes) {
  ++so_far.messages;
  so_far.empty_messages += bytes == 0;
  so_far.bytes += bytes;
}

/// Makes a call that may wait for another rank, and measures its time.
template <class Call>
void waiting(Call&& call) {
  const double begin = MPI_Wtime();
  call();
  so_far.waited += MPI_Wtime() - begin;
}

template <class Call>
void blocking_collective(MPI_Comm comm, Call&& call) {
  if (ranks_of(comm) == 1) return void(call());
  ++so_far.blocking_collectives;
  waiting(call);
}

/// A nonblocking collective.
class PendingCollective {
 public:
  /// start(request) starts the collective.
  template <class Start>
  void begin(MPI_Comm comm, Start&& start) {
    start(&request_);
    counts_ = ranks_of(comm) > 1;
    step_ = step;
  }
  bool under_way() const { return request_ != MPI_REQUEST_NULL; }
  void wait() {
    if (!under_way()) return;
    waiting([&] { MPI_Wait(&request_, MPI_STATUS_IGNORE); });
    count();
  }
  /// Returns whether it has finished.
  bool test() {
    int done = 0;
    waiting([&] { MPI_Test(&request_, &done, MPI_STATUS_IGNORE); });
    if (done) count();
    return done;
  }

 private:
  void count() {
    if (counts_) ++(step_ == step ? so_far.blocking_collectives : so_far.collectives_under_way);
  }
  MPI_Request request_ = MPI_REQUEST_NULL;
  std::uint64_t step_ = 0;  // in which it was started
  bool counts_ = false;
};

}  // namespace silt::parallel::counting
