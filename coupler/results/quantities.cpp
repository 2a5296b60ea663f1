#include "coupler/results/quantities.hpp"

#include <cmath>
#include <limits>
#include <map>
#include <string_view>

#include "coupler/analytic_flow.hpp"
#include "coupler/case/quantity_types.hpp"
#include "coupler/exchange/reduce.hpp"
#include "coupler/results/flow_quantities.hpp"
#include "coupler/results/wall_quantities.hpp"

namespace silt::coupler {

namespace {

using Spec = QuantitySpec;
using History = QuantityHistory;

constexpr double nothing = std::numeric_limits<double>::quiet_NaN();

using Observe = void (*)(const Simulation&, const Spec&, History&);
using Value = double (*)(const Simulation&, const Spec&, const History&);

double seen(const Simulation&, const Spec&, const History& h) {
  return h[0] == not_yet ? nothing : h[0];
}

double mean_seen(const Simulation&, const Spec&, const History& h) {
  return h[0] == not_yet ? nothing : h[0] / h[1];
}

template <double (*function)(const Simulation&, const Spec&)>
double at_end(const Simulation& simulation, const Spec& q, const History&) {
  return function(simulation, q);
}

template <double (*function)(const Simulation&)>
double of_flow(const Simulation& simulation, const Spec&, const History&) {
  return function(simulation);
}

double growth(const Simulation&, const Spec&, const History& h) {
  return energy_growth(h);
}

double penetration(const Simulation& simulation, const Spec&, const History&) {
  return simulation.counters().penetration;
}

/// Looks once: at the first step within half a step of the time or after it.
template <double (*function)(const Simulation&)>
void observe_instant(const Simulation& simulation, const Spec& q, History& h) {
  if (h[0] == not_yet && static_cast<double>(simulation.steps_done()) >= q.time - 0.5)
    h[0] = function(simulation);
}

template <double (*function)(const Simulation&)>
double at_instant(const Simulation& simulation, const Spec& q, const History& h) {
  return std::isfinite(q.time) ? seen(simulation, q, h) : function(simulation);
}

struct Computation {
  Observe observe;  // null: does not look at the run
  Value value;
};

/// By the name of the type: a row for each of quantity_types().
const std::map<std::string_view, Computation> computations = {
    {"max-speed", {observe_speed, seen}},
    {"drag-coefficient", {nullptr, at_end<drag_coefficient>}},
    {"superficial-velocity", {nullptr, at_end<superficial_velocity>}},
    {"profile-error", {nullptr, at_end<profile_error>}},
    {"taylor-green-velocity", {nullptr, of_flow<vortex_velocity_error>}},
    {"taylor-green-decay", {nullptr, of_flow<vortex_decay_error>}},
    {"kinetic-energy", {observe_instant<kinetic_energy>, at_instant<kinetic_energy>}},
    {"dissipation", {observe_instant<dissipation>, at_instant<dissipation>}},
    {"mean-height", {nullptr, at_end<mean_height>}},
    {"drift", {nullptr, at_end<drift>}},
    {"max-height-after", {observe_height, seen}},
    {"displacement", {nullptr, at_end<displacement>}},
    {"mean-velocity", {nullptr, at_end<mean_velocity>}},
    {"mean-angular-velocity", {nullptr, at_end<mean_angular_velocity>}},
    {"max-penetration", {nullptr, penetration}},
    {"momentum-change", {nullptr, at_end<momentum_change>}},
    {"angular-momentum-change", {nullptr, at_end<angular_momentum_change>}},
    {"energy-change", {nullptr, at_end<energy_change>}},
    {"energy-growth", {observe_energy, growth}},
    {"last-reversal", {observe_reversal, seen}},
    {"discharge-rate", {observe_discharge, discharge_rate}},
    {"bed-angle", {observe_bed, mean_seen}},
    {"rebound-ratio", {observe_rebound, rebound_ratio}},
    {"axis-distance", {nullptr, at_end<axis_distance>}},
    {"wall-stress", {observe_wall_stress, mean_seen}},
    {"wall-force", {observe_wall_force, mean_seen}},
    {"wall-torque", {observe_wall_torque, mean_seen}},
    {"relative-viscosity", {observe_relative_viscosity, mean_seen}},
    {"packing-fraction", {nullptr, at_end<packing_fraction>}},
};

}  // namespace

Quantities::Quantities(const Case& scene)
    : setup_(scene), history_(scene.quantities.size(), {not_yet, not_yet}) {
  for (const QuantitySpec& q : setup_.quantities)
    if (q.type == "profile-error") exact_profile(setup_, q.profile);
}

void Quantities::observe(const Simulation& simulation) {
  for (std::size_t i = 0; i < setup_.quantities.size(); ++i) {
    const QuantitySpec& q = setup_.quantities[i];
    if (const Observe look = computations.at(q.type).observe) look(simulation, q, history_[i]);
  }
}

std::vector<std::pair<std::string, double>> Quantities::evaluate(const Simulation& simulation) const {
  const auto history = this->history(simulation.scene().comm);
  std::vector<std::pair<std::string, double>> values;
  for (std::size_t i = 0; i < setup_.quantities.size(); ++i)
    values.emplace_back(setup_.quantities[i].name, value_of(setup_.quantities[i], simulation, history[i]));
  return values;
}

double Quantities::evaluate(const Simulation& simulation, const std::string& name) const {
  std::size_t i = 0;
  while (setup_.quantities.at(i).name != name) ++i;
  return value_of(setup_.quantities[i], simulation, history(simulation.scene().comm)[i]);
}

double Quantities::value_of(const QuantitySpec& q, const Simulation& simulation,
                            const QuantityHistory& history) const {
  const double value = computations.at(q.type).value(simulation, q, history);
  return setup_.units.physical(value, quantity_type(q.type).dimension);
}

std::vector<QuantityHistory> Quantities::history(MPI_Comm comm) const {
  std::vector<double> flat;
  for (const QuantityHistory& h : history_) flat.insert(flat.end(), h.begin(), h.end());
  max_over_ranks(comm, flat);
  std::vector<QuantityHistory> all(history_.size());
  for (std::size_t i = 0; i < all.size(); ++i) all[i] = {flat[2 * i], flat[2 * i + 1]};
  return all;
}

void Quantities::set_history(const std::vector<QuantityHistory>& history) {
  if (history.size() == history_.size()) history_ = history;
}

}  // namespace silt::coupler
