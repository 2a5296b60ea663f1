#include "coupler/results/quantities.hpp"

#include <algorithm>
#include <utility>

#include "coupler/analytic_flow.hpp"
#include "coupler/case/case.hpp"
#include "coupler/case/quantity_spec.hpp"
#include "coupler/results/bed_quantities.hpp"
#include "coupler/results/body_quantities.hpp"
#include "coupler/results/flow_quantities.hpp"
#include "coupler/results/packing_fraction.hpp"
#include "coupler/results/wall_quantities.hpp"
#include "parallel/collectives.hpp"

namespace silt::coupler {

namespace {

/// The computation of each row of quantity_types, from the families included above; a row without one does
/// not compile.
constexpr auto computations = []<std::size_t... row>(std::index_sequence<row...>) {
  return std::array{computation<TypeName(quantity_types[row].name)>...};
}
(std::make_index_sequence<quantity_types.size()>());

const Computation& computation_of(const QuantitySpec& q) {
  return computations[&quantity_type(q.type) - quantity_types.data()];
}

}  // namespace

Quantities::Quantities(const Case& scene)
    : specs_(scene.quantities), units_(scene.units), history_(scene.quantities.size(), no_history) {
  for (const QuantitySpec& q : specs_)
    if (quantity_type(q.type).takes(QuantityType::profile)) exact_profile(scene, q.profile);
}

void Quantities::observe(const Simulation& simulation) {
  for (std::size_t i = 0; i < specs_.size(); ++i) {
    const QuantitySpec& q = specs_[i];
    const Computation& c = computation_of(q);
    if (c.observe) c.observe(simulation, q, history_[i]);
    std::vector<rigid::ExactSum> terms(c.sums.count);
    if (c.sums.add && c.sums.add(simulation, q, history_[i], terms))
      sums_.add(i, simulation.steps_done(), terms);
  }
  sums_.advance(simulation.scene().comm, simulation.steps_done(), fold(simulation.setup()));
}

SumsOfSteps::Fold Quantities::fold(const Case& scene) const {
  return [this, &scene](std::size_t i, std::int64_t step, std::span<const double> sums) {
    computation_of(specs_[i]).sums.fold(scene, specs_[i], step, sums, history_[i]);
  };
}

std::vector<std::pair<std::string, double>> Quantities::evaluate(const Simulation& simulation) const {
  const auto history = this->history(simulation);
  std::vector<std::pair<std::string, double>> values;
  for (std::size_t i = 0; i < specs_.size(); ++i)
    values.emplace_back(specs_[i].name, value_of(specs_[i], simulation, history[i]));
  return values;
}

double Quantities::evaluate(const Simulation& simulation, const std::string& name) const {
  std::size_t i = 0;
  while (specs_.at(i).name != name) ++i;
  return value_of(specs_[i], simulation, history(simulation)[i]);
}

double Quantities::value_of(const QuantitySpec& q, const Simulation& simulation,
                            const QuantityHistory& history) const {
  const double value = computation_of(q).value(simulation, q, history);
  return units_.physical(value, quantity_type(q.type).dimension);
}

std::vector<std::pair<std::string, double>> Quantities::in_last_step() const {
  std::vector<std::pair<std::string, double>> values;
  for (std::size_t i = 0; i < specs_.size(); ++i)
    if (const auto f = computation_of(specs_[i]).in_last_step)
      values.emplace_back(specs_[i].name,
                          units_.physical(f(history_[i]), quantity_type(specs_[i].type).dimension));
  return values;
}

std::vector<QuantityHistory> Quantities::history(const Simulation& simulation) const {
  sums_.settle(simulation.scene().comm, fold(simulation.setup()));
  std::vector<double> flat;
  for (const QuantityHistory& h : history_) flat.insert(flat.end(), h.begin(), h.end());
  parallel::max_over_ranks(simulation.scene().comm, flat);
  std::vector<QuantityHistory> all(history_.size());
  for (std::size_t i = 0; i < all.size(); ++i)
    std::copy_n(flat.begin() + i * all[i].size(), all[i].size(), all[i].begin());
  return all;
}

void Quantities::set_history(const std::vector<QuantityHistory>& history) {
  if (history.size() == history_.size()) history_ = history;
}

}  // namespace silt::coupler
