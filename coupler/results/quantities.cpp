#include "coupler/results/quantities.hpp"

#include <algorithm>

#include "coupler/analytic_flow.hpp"
#include "coupler/case/case.hpp"
#include "parallel/collectives.hpp"

namespace silt::coupler {

const Computation& computation_of(std::string_view type) {
  for (const auto family : {body_computations(), flow_computations(), wall_computations()})
    for (const Computation& c : family)
      if (c.type == type) return c;
  throw std::logic_error("no computation of a quantity of the type " + std::string(type));
}

Quantities::Quantities(const Case& setup)
    : specs_(setup.quantities), units_(setup.units), history_(setup.quantities.size(), no_history) {
  for (const QuantitySpec& q : specs_) {
    computation_of(q.type);
    if (quantity_type(q.type).takes(QuantityType::profile)) exact_profile(setup, q.profile);
  }
}

void Quantities::observe(const Simulation& simulation) {
  const std::int64_t step = simulation.steps_done();
  for (std::size_t i = 0; i < specs_.size(); ++i) {
    const QuantitySpec& q = specs_[i];
    const Computation& c = computation_of(q.type);
    if (c.observe) c.observe(simulation, q, history_[i]);
    std::vector<rigid::ExactSum> terms(c.sums.count);
    if (!c.sums.add || !c.sums.add(simulation, q, history_[i], terms)) continue;
    waiting_.push_back({i, step, terms.size()});
    terms_.insert(terms_.end(), terms.begin(), terms.end());
  }
  if (waiting_.empty() || step - waiting_.front().step < most_steps - 1) return;
  fold_started(simulation.setup());
  start_sums(simulation.scene().comm);
}

void Quantities::start_sums(MPI_Comm comm) const {
  started_ = std::exchange(waiting_, {});
  sums_.start(comm, std::exchange(terms_, {}));
}

/// Takes the sums that were started last into the history, in the order in which they were observed.
void Quantities::fold_started(const Case& setup) const {
  if (started_.empty()) return;
  auto sum = sums_.finish().begin();
  std::vector<double> values;
  for (const Look& look : started_) {
    values.clear();
    for (std::size_t k = 0; k < look.terms; ++k) values.push_back((sum++)->value());
    const QuantitySpec& q = specs_[look.quantity];
    computation_of(q.type).sums.fold(setup, q, look.step, values, history_[look.quantity]);
  }
  started_.clear();
}

double Quantities::physical(const QuantitySpec& q, double value) const {
  return units_.physical(value, quantity_type(q.type).dimension);
}

std::vector<std::pair<std::string, double>> Quantities::evaluate(const Simulation& simulation) const {
  const auto history = this->history(simulation);
  std::vector<std::pair<std::string, double>> values;
  for (std::size_t i = 0; i < specs_.size(); ++i) {
    const QuantitySpec& q = specs_[i];
    values.emplace_back(q.name, physical(q, computation_of(q.type).value(simulation, q, history[i])));
  }
  return values;
}

double Quantities::evaluate(const Simulation& simulation, const std::string& name) const {
  std::size_t i = 0;
  while (specs_.at(i).name != name) ++i;
  const QuantitySpec& q = specs_[i];
  return physical(q, computation_of(q.type).value(simulation, q, history(simulation)[i]));
}

std::vector<std::pair<std::string, double>> Quantities::in_last_step() const {
  std::vector<std::pair<std::string, double>> values;
  for (std::size_t i = 0; i < specs_.size(); ++i)
    if (const auto value = computation_of(specs_[i].type).in_last_step)
      values.emplace_back(specs_[i].name, physical(specs_[i], value(history_[i])));
  return values;
}

std::vector<QuantityHistory> Quantities::history(const Simulation& simulation) const {
  const MPI_Comm comm = simulation.scene().comm;
  fold_started(simulation.setup());
  if (!waiting_.empty()) {
    start_sums(comm);
    fold_started(simulation.setup());
  }
  std::vector<QuantityHistory> all = history_;
  parallel::max_over_ranks(comm, std::span(reinterpret_cast<double*>(all.data()), 3 * all.size()));
  return all;
}

void Quantities::set_history(const std::vector<QuantityHistory>& history) {
  if (history.size() == history_.size()) history_ = history;
}

}  // namespace silt::coupler
