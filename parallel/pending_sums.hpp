#pragma once
// Nonblocking sums and maxima over the ranks: started at the end of a step, used in the next one.
#include <mpi.h>

#include <type_traits>
#include <utility>

#include "parallel/collectives.hpp"
#include "parallel/counted.hpp"

namespace silt::parallel {

template <class Values, class Word>
class PendingReduction {
 public:
  PendingReduction() = default;
  ~PendingReduction() { finish(); }
  PendingReduction(const PendingReduction&) = delete;
  PendingReduction& operator=(const PendingReduction&) = delete;

  /// Starts the reduction of every rank's values. Collective, but does not wait.
  void start(MPI_Comm comm, Values mine) {
    finish();
    values_ = std::move(mine);
    constexpr bool sums = std::is_same_v<Word, std::int64_t>;
    std::span<Word> words;
    if constexpr (sums)
      words = words_of(values_);
    else if constexpr (std::is_same_v<Values, std::vector<Word>>)
      words = values_;
    else
      words = {reinterpret_cast<Word*>(&values_), sizeof values_ / sizeof(Word)};
    under_way_.begin(comm, [&](MPI_Request* request) {
      MPI_Iallreduce(MPI_IN_PLACE, words.data(), static_cast<int>(words.size()),
                     sums ? MPI_INT64_T : MPI_DOUBLE, sums ? MPI_SUM : MPI_MAX, comm, request);
    });
  }
  bool under_way() const { return under_way_.under_way(); }
  /// Waits for the last reduction and returns its result.
  const Values& finish() {
    under_way_.wait();
    return values_;
  }

 private:
  Values values_{};
  counting::PendingCollective under_way_;
};

/// Sums of an integer, a record of sums (sum_over_ranks), or an equally long vector of either.
template <class Sums>
using PendingSums = PendingReduction<Sums, std::int64_t>;
/// Maxima over ranks of each member of a record of doubles, or of a vector of equal length on every rank.
template <class Record>
using PendingMaxima = PendingReduction<Record, double>;

}  // namespace silt::parallel
