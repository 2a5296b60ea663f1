#pragma once
// The figures of [[quantities]] that look at the fluid. Each is collective and the same on every rank and any
// number of ranks; lattice units; NaN where there is nothing to speak of.
#include "coupler/simulation.hpp"

namespace silt::coupler {

/// F / (6 pi mu a U) of the fixed bodies of a kind, along the axis.
double drag_coefficient(const Simulation&, const QuantitySpec&);
/// Mean over all cells of the fluid's velocity along the axis relative to the mean velocity of the bodies of
/// a kind, those inside bodies counting as zero.
double superficial_velocity(const Simulation&, const QuantitySpec&);
/// Largest deviation from the analytic profile, over its largest value.
double profile_error(const Simulation&, const QuantitySpec&);
/// Of the decaying Taylor-Green vortex: relative L2 error of the velocity; relative error of the decay rate.
double vortex_velocity_error(const Simulation&);
double vortex_decay_error(const Simulation&);
/// Mean of |u|^2 / 2 over the fluid, and of 2 nu S : S, S the rate of strain that each cell's populations
/// hold.
double kinetic_energy(const Simulation&);
double dissipation(const Simulation&);

}  // namespace silt::coupler
