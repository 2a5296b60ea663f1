#pragma once
// Sums over the ranks that nobody waits for: started at the end of a step, used in the next one.
#include <mpi.h>

#include <cstdint>
#include <utility>
#include <vector>

namespace silt::coupler {

class SumsUnderWay {
 public:
  SumsUnderWay() = default;
  ~SumsUnderWay() { finish(); }
  SumsUnderWay(const SumsUnderWay&) = delete;
  SumsUnderWay& operator=(const SumsUnderWay&) = delete;

  /// Starts the sums of as many integers on every rank. Collective, but waits for nobody.
  void start(MPI_Comm comm, std::vector<std::int64_t> mine) {
    finish();
    sums_ = std::move(mine);
    MPI_Iallreduce(MPI_IN_PLACE, sums_.data(), static_cast<int>(sums_.size()), MPI_INT64_T, MPI_SUM, comm,
                   &request_);
  }
  bool under_way() const { return request_ != MPI_REQUEST_NULL; }
  /// Returns the sums of the last start, once all ranks have come to it.
  const std::vector<std::int64_t>& finish() {
    if (under_way()) MPI_Wait(&request_, MPI_STATUS_IGNORE);
    return sums_;
  }

 private:
  std::vector<std::int64_t> sums_;
  MPI_Request request_ = MPI_REQUEST_NULL;
};

}  // namespace silt::coupler
