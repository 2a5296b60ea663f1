#pragma once
// The values of the quantities a case asks for under [[quantities]], in the units of the case: at the end,
// and in steps, for the rows of [[output.series]].
#include <string>
#include <utility>
#include <vector>

#include "parallel/pending_sums.hpp"
#include "silt/case/output_spec.hpp"
#include "silt/case/units.hpp"
#include "silt/results/quantity_computation.hpp"
#include "silt/results/run_tables.hpp"

namespace silt {

/// What a column of a series has gathered for its next row: the sum over the steps that have a value, and
/// their number.
struct StepMean {
  double sum = 0, count = 0;

  void add(double value);  // NaN for a step without one
  double value() const { return count > 0 ? sum / count : no_value; }
};
using SeriesMeans = std::vector<std::vector<StepMean>>;  // of each series, by column

class Quantities {
 public:
  /// The sums over the ranks are started when this many steps wait for them.
  static constexpr std::int64_t most_steps = 64;

  explicit Quantities(const Case&);

  /// Collective, but waits for no rank; to be called at the start and after every step. Does nothing unless a
  /// quantity looks at the whole run, or a series at this step.
  void observe(const Simulation&);
  /// Collective: waits for all that has been observed.
  void settle(const Simulation&) const;
  /// Returns the rows that have become known since the last call, of each series; the same on every rank.
  /// After settle these are the rows of all steps so far, else some may still be under way.
  std::vector<TableRows> take_rows();
  static std::string columns(const ColumnsSpec&);
  /// Collective. Returns names and values in the order of the case, the same on every rank and any number of
  /// ranks; NaN for a value that does not exist (no such body, no step yet).
  std::vector<std::pair<std::string, double>> evaluate(const Simulation&) const;
  /// Collective. Returns the value of one quantity; std::out_of_range for a name the case does not give.
  double evaluate(const Simulation&, const std::string& name) const;
  /// Returns the values in the last step of means over steps, by name, as of the last evaluate().
  std::vector<std::pair<std::string, double>> in_last_step() const;

  /// Collective. Returns what observe has gathered, for checkpoints.
  std::vector<QuantityHistory> history(const Simulation&) const;
  void set_history(const std::vector<QuantityHistory>&);
  /// Returns what rows to come have gathered up to the last settle() or history(), for checkpoints.
  const SeriesMeans& means() const { return means_; }
  void set_means(const SeriesMeans&);

 private:
  /// A Look is what a quantity adds up of a step: where its terms begin, of which several may have the same.
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
  std::vector<const Computation*> computations_;   // of each quantity
  std::vector<std::vector<std::size_t>> columns_;  // of each series: its quantities
  std::vector<std::size_t> as_;                    // of each quantity: the first with the same terms, or none
  // The history on this rank. Observations that are not yet summed join it when somebody asks for it.
  mutable std::vector<QuantityHistory> history_;
  mutable std::vector<Look> waiting_, started_;
  mutable std::vector<rigid::ExactSum> sums_;  // of the looks that wait
  mutable std::vector<double> largest_;        // the same
  mutable parallel::PendingSums<std::vector<rigid::ExactSum>> sums_under_way_;
  mutable parallel::PendingMaxima<std::vector<double>> largest_under_way_;
  mutable SeriesMeans means_;
  mutable std::vector<TableRows> rows_;  // of each series
};

}  // namespace silt
