#pragma once
// The figures a case asks for under [[quantities]] (see QuantitySpec), in the units of the case.
#include <string>
#include <utility>
#include <vector>

#include "coupler/results/body_quantities.hpp"

namespace silt::coupler {

class Quantities {
 public:
  /// Throws CaseError for a quantity this scene cannot have (a profile without its walls).
  explicit Quantities(const Case&);

  /// Collective; at the start and after every step. Does nothing unless a quantity looks at the whole run.
  void observe(const Simulation&);
  /// Collective; the same on every rank and any number of ranks. In the order of the case. NaN where there is
  /// nothing to speak of (no such body, no step yet).
  std::vector<std::pair<std::string, double>> evaluate(const Simulation&) const;
  /// The same of one; std::out_of_range for a name the case does not give.
  double evaluate(const Simulation&, const std::string& name) const;

  /// What observe has gathered: for checkpoints. Collective.
  std::vector<QuantityHistory> history(MPI_Comm) const;
  void set_history(const std::vector<QuantityHistory>&);

 private:
  double value_of(const QuantitySpec&, const Simulation&, const QuantityHistory&) const;
  const Case setup_;
  std::vector<QuantityHistory> history_;  // on this rank
};

}  // namespace silt::coupler
