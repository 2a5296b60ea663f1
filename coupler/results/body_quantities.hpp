#pragma once
// Quantities that look at the bodies; sums are exact. Positions at the start come from the case, not from
// memory. Meanings: coupler/case/quantity_spec.hpp.
#include <functional>

#include "coupler/results/quantity_computation.hpp"

namespace silt::coupler {

/// Returns the mean over the bodies a quantity is about of value(row), which is asked for each owned one.
double mean_over_bodies(const Simulation&, const QuantitySpec&,
                        const std::function<double(std::size_t)>& value);

// ---- at the end ----

double mean_height(const Simulation&, const QuantitySpec&);
template <>
inline constexpr Computation computation<"mean-height"> = at_end<mean_height>;

double drift(const Simulation&, const QuantitySpec&);
template <>
inline constexpr Computation computation<"drift"> = at_end<drift>;

double displacement(const Simulation&, const QuantitySpec&);
template <>
inline constexpr Computation computation<"displacement"> = at_end<displacement>;

double mean_velocity(const Simulation&, const QuantitySpec&);
template <>
inline constexpr Computation computation<"mean-velocity"> = at_end<mean_velocity>;

double mean_angular_velocity(const Simulation&, const QuantitySpec&);
template <>
inline constexpr Computation computation<"mean-angular-velocity"> = at_end<mean_angular_velocity>;

/// Momentum, angular momentum, energy and the sum of |m v| of the free bodies, before the first step.
bool add_totals_at_start(const Simulation&, const QuantitySpec&, const QuantityHistory&,
                         std::span<rigid::ExactSum>);

void keep_momentum(const Case&, const QuantitySpec&, std::int64_t, std::span<const double>, QuantityHistory&);
double momentum_change(const Simulation&, const QuantitySpec&, const QuantityHistory& start);
template <>
inline constexpr Computation computation<"momentum-change"> = {
    nullptr, momentum_change, {8, add_totals_at_start, keep_momentum}};

void keep_angular_momentum(const Case&, const QuantitySpec&, std::int64_t, std::span<const double>,
                           QuantityHistory&);
double angular_momentum_change(const Simulation&, const QuantitySpec&, const QuantityHistory& start);
template <>
inline constexpr Computation computation<"angular-momentum-change"> = {
    nullptr, angular_momentum_change, {8, add_totals_at_start, keep_angular_momentum}};

void keep_energy(const Case&, const QuantitySpec&, std::int64_t, std::span<const double>, QuantityHistory&);
double energy_change(const Simulation&, const QuantitySpec&, const QuantityHistory& start);
template <>
inline constexpr Computation computation<"energy-change"> = {
    nullptr, energy_change, {8, add_totals_at_start, keep_energy}};

double bodies_in_box(const Simulation&, const QuantitySpec&);
template <>
inline constexpr Computation computation<"body-count"> = at_end<bodies_in_box>;

/// Returns what the run's counters hold.
double max_penetration(const Simulation&);
template <>
inline constexpr Computation computation<"max-penetration"> = at_end<max_penetration>;

// ---- over the run ----

void observe_speed(const Simulation&, const QuantitySpec&, QuantityHistory& largest);
template <>
inline constexpr Computation computation<"max-speed"> = seen<observe_speed>;

void observe_height(const Simulation&, const QuantitySpec&, QuantityHistory& largest);
template <>
inline constexpr Computation computation<"max-height-after"> = seen<observe_height>;

void observe_reversal(const Simulation&, const QuantitySpec&, QuantityHistory& latest);
template <>
inline constexpr Computation computation<"last-reversal"> = seen<observe_reversal>;

bool add_energy(const Simulation&, const QuantitySpec&, const QuantityHistory&, std::span<rigid::ExactSum>);
void keep_largest_energy(const Case&, const QuantitySpec&, std::int64_t, std::span<const double>,
                         QuantityHistory& at_start_and_largest);
double energy_growth(const Simulation&, const QuantitySpec&, const QuantityHistory&);
template <>
inline constexpr Computation computation<"energy-growth"> = {
    nullptr, energy_growth, {1, add_energy, keep_largest_energy}};

bool add_mass_below(const Simulation&, const QuantitySpec&, const QuantityHistory&,
                    std::span<rigid::ExactSum>);
void keep_first_mass(const Case&, const QuantitySpec&, std::int64_t, std::span<const double>,
                     QuantityHistory& mass_and_step);
double discharge_rate(const Simulation&, const QuantitySpec&, const QuantityHistory&);
template <>
inline constexpr Computation computation<"discharge-rate"> = {
    nullptr, discharge_rate, {1, add_mass_below, keep_first_mass}};

void observe_outflow(const Simulation&, const QuantitySpec&, QuantityHistory& number_and_step);
double outflow_rate(const Simulation&, const QuantitySpec&, const QuantityHistory&);
template <>
inline constexpr Computation computation<"outflow-rate"> = {observe_outflow, outflow_rate};

void observe_rebound(const Simulation&, const QuantitySpec&, QuantityHistory& against_and_along);
double rebound_ratio(const Simulation&, const QuantitySpec&, const QuantityHistory&);
template <>
inline constexpr Computation computation<"rebound-ratio"> = {observe_rebound, rebound_ratio};

}  // namespace silt::coupler
