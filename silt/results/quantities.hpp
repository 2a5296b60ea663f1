#pragma once
// Computes the [[quantities]] of a case in its units: at the end, and in steps for rows of [[output.series]].
#include <string>
#include <utility>
#include <vector>

#include "parallel/pending_sums.hpp"
#include "silt/case/output_spec.hpp"
#include "silt/case/units.hpp"
#include "silt/results/quantity_computation.hpp"
#include "silt/results/run_tables.hpp"

namespace silt {

/// The sum and number of values that a column of a series has collected for its next row.
struct StepMean {
  double sum = 0, count = 0;

  void add(double value);  // NaN: the step has no value
  double value() const { return count > 0 ? sum / count : no_value; }
};
using SeriesMeans = std::vector<std::vector<StepMean>>;  // per series and column

class Quantities {
 public:
  /// The sums over ranks start when this number of steps is waiting.
  static constexpr std::int64_t most_steps = 64;

  explicit Quantities(const Case&);

  /// Call at the start and after every step. Does nothing unless a quantity needs the whole run or a series
  /// this step. Collective, but waits for no rank.
  void observe(const Simulation&);
  /// Waits for all sums of observed steps. Collective.
  void settle(const Simulation&) const;
  /// Returns the new rows of each series since the last call, the same on every rank. They are complete after
  /// settle(); otherwise some may still be under way.
  std::vector<TableRows> take_rows();
  static std::string columns(const ColumnsSpec&);
  /// Returns names and values in the order of the case, the same on every rank and any number of ranks; NaN
  /// for a value that does not exist (no such body, no step yet). Collective.
  std::vector<std::pair<std::string, double>> evaluate(const Simulation&) const;
  /// Returns the value of one quantity. Collective. Throws std::out_of_range for an unknown name.
  double evaluate(const Simulation&, const std::string& name) const;
  /// Returns, by name, the values in the last step of means over steps, at the last evaluate().
  std::vector<std::pair<std::string, double>> in_last_step() const;

  /// Returns the accumulated data for checkpoints. Collective.
  std::vector<QuantityHistory> history(const Simulation&) const;
  void set_history(const std::vector<QuantityHistory>&);
  /// Returns the sums of unfinished rows at the last settle() or history(), for checkpoints.
  const SeriesMeans& means() const { return means_; }
  void set_means(const SeriesMeans&);

 private:
  /// The terms of a quantity in a step: where they begin in the sums. Quantities may share terms.
  struct Look {
    std::size_t quantity;
    std::int64_t step;
    std::size_t first_sum, first_largest;
    bool counts, in_row;
  };
  static constexpr std::size_t none = -1;
  double physical(const QuantitySpec&, double value) const;
  double value(const Simulation&, std::size_t quantity, const QuantityHistory&) const;
  bool is_in_row(std::size_t quantity, std::int64_t step) const;
  Look look(const Simulation&, std::size_t quantity, bool in_row) const;
  void start_sums(MPI_Comm) const;
  void fold_started(const Case&) const;
  void fold(const Case&, const Look&, std::vector<double>& in_step) const;
  void add_rows(std::int64_t step, const std::vector<double>& in_step) const;

  const std::vector<QuantitySpec> specs_;
  const Units units_;
  const std::vector<ColumnsSpec> series_;
  std::vector<const Computation*> computations_;   // per quantity
  std::vector<std::vector<std::size_t>> columns_;  // per series: its quantities
  std::vector<std::size_t> as_;                    // per quantity: the first with the same terms, or none
  // This rank's history. Observations are added to it when their sums are complete.
  mutable std::vector<QuantityHistory> history_;
  mutable std::vector<Look> waiting_, started_;
  mutable std::vector<rigid::ExactSum> sums_;  // of waiting steps
  mutable std::vector<double> largest_;        // likewise
  mutable parallel::PendingSums<std::vector<rigid::ExactSum>> sums_under_way_;
  mutable parallel::PendingMaxima<std::vector<double>> largest_under_way_;
  mutable SeriesMeans means_;
  mutable std::vector<TableRows> rows_;  // per series
};

}  // namespace silt
