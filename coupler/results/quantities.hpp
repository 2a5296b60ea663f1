#pragma once
// The values of the quantities a case asks for under [[quantities]], in the units of the case.
#include <string>
#include <utility>
#include <vector>

#include "coupler/case/units.hpp"
#include "coupler/results/quantity_computation.hpp"
#include "parallel/sums_under_way.hpp"

namespace silt::coupler {

class Quantities {
 public:
  /// So many steps wait at most before their sums over the ranks are started; as many are then under way.
  static constexpr std::int64_t most_steps = 64;

  /// Throws CaseError for a quantity this case cannot have (a profile without its walls).
  explicit Quantities(const Case&);

  /// Collective, but waits for no rank; to be called at the start and after every step. Does nothing unless a
  /// quantity looks at the whole run.
  void observe(const Simulation&);
  /// Collective. Returns names and values in the order of the case, the same on every rank and any number of
  /// ranks; NaN for a value that does not exist (no such body, no step yet).
  std::vector<std::pair<std::string, double>> evaluate(const Simulation&) const;
  /// Collective. Returns the value of one quantity; std::out_of_range for a name the case does not give.
  double evaluate(const Simulation&, const std::string& name) const;
  /// Returns the values in the last step of those that are means over steps, by name, as evaluate has brought
  /// them up to date.
  std::vector<std::pair<std::string, double>> in_last_step() const;

  /// Collective. Returns what observe has gathered, for checkpoints.
  std::vector<QuantityHistory> history(const Simulation&) const;
  void set_history(const std::vector<QuantityHistory>&);

 private:
  /// A Look is what a quantity adds up of a step: so many terms.
  struct Look {
    std::size_t quantity;
    std::int64_t step;
    std::size_t terms;
  };
  double physical(const QuantitySpec&, double value) const;
  void start_sums(MPI_Comm) const;
  void fold_started(const Case&) const;

  const std::vector<QuantitySpec> specs_;
  const Units units_;
  // On this rank; what has been observed and not yet been summed joins the history when somebody asks for it.
  mutable std::vector<QuantityHistory> history_;
  mutable std::vector<Look> waiting_, started_;
  mutable std::vector<rigid::ExactSum> terms_;  // of the looks that wait
  mutable parallel::SumsUnderWay<std::vector<rigid::ExactSum>> sums_;
};

}  // namespace silt::coupler
