#pragma once
// The figures of [[quantities]] that look at what fluid and bodies do to the walls. Each is collective and
// the same on every rank and any number of ranks; lattice units; means over the steps from a time on.
#include "coupler/results/body_quantities.hpp"

namespace silt::coupler {

/// Mean distance of the bodies' centres from the axis of a tube, at the end.
double axis_distance(const Simulation&, const QuantitySpec&);

/// Force along an axis on a side of the domain, per area: of the fluid, and of the bodies that touch it
/// (contacts: of the last sub-step of each step).
void observe_wall_stress(const Simulation&, const QuantitySpec&, QuantityHistory& sum_and_count);
/// Shear stress on both sides across an axis, their mean, over that of the fluid alone at the same mean shear
/// rate.
void observe_relative_viscosity(const Simulation&, const QuantitySpec&, QuantityHistory& sum_and_count);
/// Force on a curved wall along an axis, and torque on it about the tube's axis; of fluid and bodies too.
void observe_wall_force(const Simulation&, const QuantitySpec&, QuantityHistory& sum_and_count);
void observe_wall_torque(const Simulation&, const QuantitySpec&, QuantityHistory& sum_and_count);

}  // namespace silt::coupler
