#pragma once
// The figures of [[quantities]] that look at the bodies. Each is collective and the same on every rank and
// any number of ranks (sums are in fixed point); lattice units; NaN where there is nothing to speak of. What
// the start was like comes from the case, not from memory. Meanings: cases/README.md.
#include <array>
#include <functional>
#include <limits>

#include "coupler/simulation.hpp"

namespace silt::coupler {

/// What a quantity that looks at the whole run has gathered so far: two numbers, of which the largest over
/// the ranks counts.
using QuantityHistory = std::array<double, 2>;
inline constexpr double not_yet = -std::numeric_limits<double>::infinity();

/// Mean over the bodies a quantity is about: value(row) of each owned one.
double mean_over_bodies(const Simulation&, const QuantitySpec&,
                        const std::function<double(std::size_t)>& value);

// ---- at the end ----
double mean_height(const Simulation&, const QuantitySpec&);
double drift(const Simulation&, const QuantitySpec&);
double displacement(const Simulation&, const QuantitySpec&);
double mean_velocity(const Simulation&, const QuantitySpec&);
double mean_angular_velocity(const Simulation&, const QuantitySpec&);
double momentum_change(const Simulation&, const QuantitySpec&);
double angular_momentum_change(const Simulation&, const QuantitySpec&);
double energy_change(const Simulation&, const QuantitySpec&);
double packing_fraction(const Simulation&, const QuantitySpec&);

// ---- over the run: what is looked at after every step (collective where it sums), what comes of it ----
void observe_speed(const Simulation&, const QuantitySpec&, QuantityHistory& largest);
void observe_height(const Simulation&, const QuantitySpec&, QuantityHistory& largest);
void observe_reversal(const Simulation&, const QuantitySpec&, QuantityHistory& latest);
void observe_energy(const Simulation&, const QuantitySpec&, QuantityHistory& at_start_and_largest);
double energy_growth(const QuantityHistory&);
void observe_discharge(const Simulation&, const QuantitySpec&, QuantityHistory& mass_and_step);
double discharge_rate(const Simulation&, const QuantitySpec&, const QuantityHistory&);
void observe_rebound(const Simulation&, const QuantitySpec&, QuantityHistory& against_and_along);
double rebound_ratio(const Simulation&, const QuantitySpec&, const QuantityHistory&);
void observe_bed(const Simulation&, const QuantitySpec&, QuantityHistory& sum_and_count);

}  // namespace silt::coupler
