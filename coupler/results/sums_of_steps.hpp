#pragma once
// Sums over the ranks of what quantities look at after every step, many steps in one message: a step waits
// for none of them.
#include <mpi.h>

#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "parallel/sums_under_way.hpp"
#include "rigid/math/exact_sum.hpp"

namespace silt::coupler {

class SumsOfSteps {
 public:
  /// So many steps wait at most before their sums are started; as many are then under way.
  static constexpr std::int64_t most_steps = 64;
  /// Takes the sums of one quantity and step: quantity, step, sums.
  using Fold = std::function<void(std::size_t, std::int64_t, std::span<const double>)>;

  /// This rank's terms; alike on every rank but for their values, in the order of steps.
  void add(std::size_t quantity, std::int64_t step, std::span<const rigid::ExactSum> terms);
  /// After every step, collective: starts the sums of what waits, if that is enough, and folds those started
  /// before in the order of add.
  void advance(MPI_Comm, std::int64_t step, const Fold&);
  /// Collective, waits for all ranks: sums and folds all there is.
  void settle(MPI_Comm, const Fold&);

 private:
  struct Look {
    std::size_t quantity;
    std::int64_t step;
    std::size_t count;  // of sums
  };
  void start(MPI_Comm);
  void fold_started(const Fold&);

  std::vector<Look> waiting_, started_;
  std::vector<rigid::ExactSum> terms_;  // of the looks that wait
  parallel::SumsUnderWay<std::vector<rigid::ExactSum>> sums_;
};

}  // namespace silt::coupler
