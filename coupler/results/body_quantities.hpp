#pragma once
// Quantities that look at the bodies; sums are in fixed point. The state at the start comes from the case,
// not from memory. Meanings: coupler/case/quantity_types.hpp.
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

double momentum_change(const Simulation&, const QuantitySpec&);
template <>
inline constexpr Computation computation<"momentum-change"> = at_end<momentum_change>;

double angular_momentum_change(const Simulation&, const QuantitySpec&);
template <>
inline constexpr Computation computation<"angular-momentum-change"> = at_end<angular_momentum_change>;

double energy_change(const Simulation&, const QuantitySpec&);
template <>
inline constexpr Computation computation<"energy-change"> = at_end<energy_change>;

double bodies_in_box(const Simulation&, const QuantitySpec&);
template <>
inline constexpr Computation computation<"body-count"> = at_end<bodies_in_box>;

double packing_fraction(const Simulation&, const QuantitySpec&);
template <>
inline constexpr Computation computation<"packing-fraction"> = at_end<packing_fraction>;

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

void observe_energy(const Simulation&, const QuantitySpec&, QuantityHistory& at_start_and_largest);
double energy_growth(const Simulation&, const QuantitySpec&, const QuantityHistory&);
template <>
inline constexpr Computation computation<"energy-growth"> = {observe_energy, energy_growth};

void observe_discharge(const Simulation&, const QuantitySpec&, QuantityHistory& mass_and_step);
double discharge_rate(const Simulation&, const QuantitySpec&, const QuantityHistory&);
template <>
inline constexpr Computation computation<"discharge-rate"> = {observe_discharge, discharge_rate};

void observe_outflow(const Simulation&, const QuantitySpec&, QuantityHistory& number_and_step);
double outflow_rate(const Simulation&, const QuantitySpec&, const QuantityHistory&);
template <>
inline constexpr Computation computation<"outflow-rate"> = {observe_outflow, outflow_rate};

void observe_rebound(const Simulation&, const QuantitySpec&, QuantityHistory& against_and_along);
double rebound_ratio(const Simulation&, const QuantitySpec&, const QuantityHistory&);
template <>
inline constexpr Computation computation<"rebound-ratio"> = {observe_rebound, rebound_ratio};

void observe_bed(const Simulation&, const QuantitySpec&, QuantityHistory& sum_and_count);
template <>
inline constexpr Computation computation<"bed-angle"> = mean_of<observe_bed>;

}  // namespace silt::coupler
