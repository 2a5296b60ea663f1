#pragma once
// The figures a case asks for under [[quantities]] (see QuantitySpec), in the units of the case.
#include <string>
#include <utility>
#include <vector>

#include "coupler/simulation.hpp"

namespace silt::coupler {

class Quantities {
 public:
  /// Throws CaseError for a quantity this scene cannot have (a profile without its walls).
  explicit Quantities(const Case&);

  /// Local; at the start and after every step. Does nothing unless a quantity looks at the whole run.
  void observe(const Simulation&);
  /// Collective; the same on every rank and any number of ranks. In the order of the case. NaN where there is
  /// nothing to speak of (no such body, no step yet).
  std::vector<std::pair<std::string, double>> evaluate(const Simulation&) const;

  /// What observe has gathered, one number a quantity: for checkpoints. Collective.
  std::vector<double> history(MPI_Comm) const;
  void set_history(const std::vector<double>&);

 private:
  double lattice_value(const Simulation&, const QuantitySpec&, double largest) const;
  const Case setup_;
  std::vector<double> largest_;  // so far, on this rank, of those that are a largest value
  bool observes_ = false;
};

}  // namespace silt::coupler
