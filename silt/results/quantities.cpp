#include "silt/results/quantities.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "parallel/collectives.hpp"
#include "silt/case/case.hpp"

namespace silt {

namespace {

template <class Visit>
void for_rows(Visit&& visit) {
  for (const auto family :
       {body_quantities, flow_quantities, heat_quantities, motion_quantities, wall_quantities})
    std::ranges::for_each(family, visit);
}

/// Returns the types of all families. Means over steps take the key `time`; values of every step are
/// stepwise.
std::vector<QuantityType> types_of_rows() {
  std::vector<QuantityType> types;
  for_rows([&](const Quantity& row) {
    QuantityType& type = types.emplace_back(row.type);
    if (row.computation.in_last_step) type.keys |= Q::time;
    if (row.computation.in_step.of) type.needs |= Q::stepwise;
  });
  return types;
}

}  // namespace

const std::vector<QuantityType> quantity_types = types_of_rows();

const Computation& computation_of(std::string_view type) {
  const Computation* found = nullptr;
  for_rows([&](const Quantity& row) { found = row.type.name == type ? &row.computation : found; });
  if (!found) throw std::logic_error("no computation of a quantity of the type " + std::string(type));
  return *found;
}

double value_in_last_step(const Simulation& simulation, const QuantitySpec& q) {
  const auto& [count, add, counts] = computation_of(q.type).sums;
  const StepValue& in_step = computation_of(q.type).in_step;
  if (counts && !counts(simulation, q, no_history)) return no_value;
  std::vector<rigid::ExactSum> sums(count);
  std::vector<double> values(count + in_step.largest, not_yet);
  const auto largest = std::span(values).subspan(count);
  if (add) add(simulation, q, sums);
  if (in_step.see) in_step.see(simulation, q, largest);
  const MPI_Comm comm = simulation.scene().comm;
  parallel::sum_over_ranks(comm, std::span(sums));
  parallel::max_over_ranks(comm, largest);
  for (std::size_t k = 0; k < sums.size(); ++k) values[k] = sums[k].value();
  return in_step.of(simulation.setup(), q, simulation.steps_done(), values);
}

void StepMean::add(double value) {
  if (std::isnan(value)) return;
  sum = count > 0 ? sum + value : value;
  ++count;
}

namespace {

/// Returns whether two quantities have the same terms in a step.
bool have_same_terms(QuantitySpec a, QuantitySpec b) {
  const Computation &x = computation_of(a.type), &y = computation_of(b.type);
  const StepValue &u = x.in_step, &v = y.in_step;
  if (!u.of || !v.of || x.sums.add != y.sums.add || x.sums.count != y.sums.count || u.see != v.see)
    return false;
  for (QuantitySpec* q : {&a, &b}) {
    q->name = q->type = "", q->time = 0, q->over = {};
    if (u.of_all_axes) q->axis = 0;
  }
  return a == b;
}

}  // namespace

Quantities::Quantities(const Case& setup)
    : specs_(setup.quantities),
      units_(setup.units),
      series_(setup.output.series),
      history_(setup.quantities.size(), no_history),
      rows_(setup.output.series.size()) {
  for (const QuantitySpec& q : specs_) {
    computations_.push_back(&computation_of(q.type));
    std::size_t first = 0;
    while (&specs_[first] != &q && !have_same_terms(specs_[first], q)) ++first;
    as_.push_back(&specs_[first] == &q ? none : first);
  }
  for (const ColumnsSpec& series : series_) {
    std::vector<std::size_t>& columns = columns_.emplace_back();
    for (const std::string& name : series.columns) {
      const auto named = [&](const QuantitySpec& q) { return q.name == name; };
      columns.push_back(std::find_if(specs_.begin(), specs_.end(), named) - specs_.begin());
    }
    means_.emplace_back(columns.size());
  }
}

bool Quantities::is_in_row(std::size_t quantity, std::int64_t step) const {
  for (std::size_t s = 0; s < series_.size(); ++s)
    if (series_[s].takes(step) &&
        std::find(columns_[s].begin(), columns_[s].end(), quantity) != columns_[s].end())
      return true;
  return false;
}

/// Adds the terms of a quantity to the waiting sums, or shares those of another in this step.
Quantities::Look Quantities::look(const Simulation& simulation, std::size_t i, bool in_row) const {
  const QuantitySpec& q = specs_[i];
  const auto& [count, add, counts] = computations_[i]->sums;
  const StepValue& in_step = computations_[i]->in_step;
  const std::int64_t step = simulation.steps_done();
  for (auto other = waiting_.rbegin(); as_[i] != none && other != waiting_.rend() && other->step == step;
       ++other)
    if (other->quantity == as_[i] || as_[other->quantity] == as_[i]) {
      Look same = *other;
      same.quantity = i, same.in_row = in_row;
      return same;
    }
  Look look{i, step, sums_.size(), largest_.size(), !counts || counts(simulation, q, history_[i]), in_row};
  largest_.resize(largest_.size() + in_step.largest, not_yet);
  if (add && look.counts) {
    sums_.resize(sums_.size() + count);
    add(simulation, q, std::span(sums_).subspan(look.first_sum));
  }
  if (in_step.see) in_step.see(simulation, q, std::span(largest_).subspan(look.first_largest));
  return look;
}

void Quantities::observe(const Simulation& simulation) {
  const std::int64_t step = simulation.steps_done();
  for (std::size_t i = 0; i < specs_.size(); ++i) {
    const Computation& c = *computations_[i];
    if (c.observe && !specs_[i].over) c.observe(simulation, specs_[i], history_[i]);
    const bool in_row = is_in_row(i, step);
    if (!c.fold && !specs_[i].over && !in_row) continue;
    const Look found = look(simulation, i, in_row);
    if (found.counts || in_row) waiting_.push_back(found);
  }
  if (waiting_.empty() || step - waiting_.front().step < most_steps - 1) return;
  fold_started(simulation.setup());
  start_sums(simulation.scene().comm);
}

void Quantities::start_sums(MPI_Comm comm) const {
  started_ = std::exchange(waiting_, {});
  if (!sums_.empty()) sums_under_way_.start(comm, std::exchange(sums_, {}));
  if (!largest_.empty()) largest_under_way_.start(comm, std::exchange(largest_, {}));
}

/// Adds the completed sums to history and rows, in the order of observation.
void Quantities::fold_started(const Case& setup) const {
  std::vector<double> in_step(specs_.size(), no_value);
  for (std::size_t k = 0; k < started_.size(); ++k) {
    fold(setup, started_[k], in_step);
    if (k + 1 < started_.size() && started_[k + 1].step == started_[k].step) continue;
    add_rows(started_[k].step, in_step);
    std::fill(in_step.begin(), in_step.end(), no_value);
  }
  started_.clear();
}

/// Takes a value into the number of values, their mean and the sum of squares about it (Welford 1962).
static void fold_over(const QuantitySpec& q, std::int64_t step, double value, QuantityHistory& h) {
  constexpr double rounding = 1e-6;  // of times that are meant to be whole steps
  if (std::isnan(value) || double(step) < q.over->from - rounding || double(step) > q.over->to + rounding)
    return;
  if (h == no_history) h = {};
  const double away = value - h[1];
  h[0] += 1;
  h[1] += away / h[0];
  h[2] += away * (value - h[1]);
}

void Quantities::fold(const Case& setup, const Look& look, std::vector<double>& in_step) const {
  if (!look.counts) return;
  const QuantitySpec& q = specs_[look.quantity];
  const Computation& c = *computations_[look.quantity];
  std::vector<double> values;
  for (int k = 0; k < c.sums.count; ++k)
    values.push_back(sums_under_way_.finish()[look.first_sum + k].value());
  if (c.fold && !q.over) c.fold(setup, q, look.step, values, history_[look.quantity]);
  for (int k = 0; k < c.in_step.largest; ++k)
    values.push_back(largest_under_way_.finish()[look.first_largest + k]);
  if (q.over) fold_over(q, look.step, c.in_step.of(setup, q, look.step, values), history_[look.quantity]);
  if (look.in_row) in_step[look.quantity] = physical(q, c.in_step.of(setup, q, look.step, values));
}

void Quantities::add_rows(std::int64_t step, const std::vector<double>& in_step) const {
  for (std::size_t s = 0; s < series_.size(); ++s) {
    if (!series_[s].takes(step)) continue;
    for (std::size_t k = 0; k < means_[s].size(); ++k) means_[s][k].add(in_step[columns_[s][k]]);
    if (step % series_[s].every != 0) continue;
    rows_[s].last_step = step;
    rows_[s].text += fmt::format("{},{}", step, double(step) * units_.time_step);
    for (StepMean& mean : means_[s]) rows_[s].text += ',' + csv_number(std::exchange(mean, {}).value());
    rows_[s].text += '\n';
  }
}

std::vector<TableRows> Quantities::take_rows() {
  return std::exchange(rows_, std::vector<TableRows>(series_.size()));
}

std::string Quantities::columns(const ColumnsSpec& series) {
  std::string names = "step,time";
  for (const std::string& name : series.columns) names += ',' + csv_field(name);
  return names;
}

double Quantities::physical(const QuantitySpec& q, double value) const {
  return units_.physical(value, quantity_type(q.type).dimension);
}

double Quantities::value(const Simulation& simulation, std::size_t i, const QuantityHistory& h) const {
  const QuantitySpec& q = specs_[i];
  const auto of_steps = [&] { return q.over->deviation ? std::sqrt(h[2] / h[0]) : h[1]; };
  return physical(q, !q.over           ? computations_[i]->value(simulation, q, h)
                     : h == no_history ? no_value
                                       : of_steps());
}

std::vector<std::pair<std::string, double>> Quantities::evaluate(const Simulation& simulation) const {
  const auto history = this->history(simulation);
  std::vector<std::pair<std::string, double>> values;
  for (std::size_t i = 0; i < specs_.size(); ++i)
    values.emplace_back(specs_[i].name, value(simulation, i, history[i]));
  return values;
}

double Quantities::evaluate(const Simulation& simulation, const std::string& name) const {
  std::size_t i = 0;
  while (specs_.at(i).name != name) ++i;
  return value(simulation, i, history(simulation)[i]);
}

std::vector<std::pair<std::string, double>> Quantities::in_last_step() const {
  std::vector<std::pair<std::string, double>> values;
  for (std::size_t i = 0; i < specs_.size(); ++i)
    if (const auto value = computations_[i]->in_last_step; value && !specs_[i].over)
      values.emplace_back(specs_[i].name, physical(specs_[i], value(history_[i])));
  return values;
}

void Quantities::settle(const Simulation& simulation) const {
  fold_started(simulation.setup());
  if (waiting_.empty()) return;
  start_sums(simulation.scene().comm);
  fold_started(simulation.setup());
}

std::vector<QuantityHistory> Quantities::history(const Simulation& simulation) const {
  settle(simulation);
  std::vector<QuantityHistory> all = history_;
  parallel::max_over_ranks(simulation.scene().comm,
                           std::span(reinterpret_cast<double*>(all.data()), 3 * all.size()));
  return all;
}

void Quantities::set_history(const std::vector<QuantityHistory>& history) {
  if (history.size() == history_.size()) history_ = history;
}

void Quantities::set_means(const SeriesMeans& means) {
  if (means.size() == means_.size()) means_ = means;
}

}  // namespace silt
