#pragma once
// Sums and extremes over the ranks that nobody waits for: started at the end of a step, used in the next one.
#include <mpi.h>

#include <type_traits>
#include <utility>

#include "parallel/collectives.hpp"
#include "parallel/counted.hpp"

namespace silt::parallel {

template <class Values, class Word>
class ReductionUnderWay {
 public:
  ReductionUnderWay() = default;
  ~ReductionUnderWay() { finish(); }
  ReductionUnderWay(const ReductionUnderWay&) = delete;
  ReductionUnderWay& operator=(const ReductionUnderWay&) = delete;

  /// Starts from what every rank has. Collective, but waits for nobody.
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
  /// Returns what came of the last start, once all ranks have come to it.
  const Values& finish() {
    under_way_.wait();
    return values_;
  }

 private:
  Values values_{};
  counting::CollectiveUnderWay under_way_;
};

/// Sums: an integer, a record of sums (sum_over_ranks), or a vector of either, of one length on every rank.
template <class Sums>
using SumsUnderWay = ReductionUnderWay<Sums, std::int64_t>;
/// A record of doubles, or a vector of them of one length on every rank: of each the largest of all ranks.
template <class Record>
using LargestUnderWay = ReductionUnderWay<Record, double>;

}  // namespace silt::parallel
