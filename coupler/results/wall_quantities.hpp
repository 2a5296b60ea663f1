#pragma once
// Quantities that look at what fluid and bodies do to the walls; means over the steps from a time on. The
// force of contacts is that of the last sub-step of each step. Meanings: coupler/case/quantity_types.hpp.
#include "coupler/results/quantity_computation.hpp"

namespace silt::coupler {

double axis_distance(const Simulation&, const QuantitySpec&);
template <>
inline constexpr Computation computation<"axis-distance"> = at_end<axis_distance>;

void observe_wall_stress(const Simulation&, const QuantitySpec&, QuantityHistory& sum_and_count);
template <>
inline constexpr Computation computation<"wall-stress"> = mean_of<observe_wall_stress>;

/// Takes the mean of the shear stresses on the two sides across the axis.
void observe_relative_viscosity(const Simulation&, const QuantitySpec&, QuantityHistory& sum_and_count);
template <>
inline constexpr Computation computation<"relative-viscosity"> = mean_of<observe_relative_viscosity>;

void observe_wall_force(const Simulation&, const QuantitySpec&, QuantityHistory& sum_and_count);
template <>
inline constexpr Computation computation<"wall-force"> = mean_of<observe_wall_force>;

void observe_wall_torque(const Simulation&, const QuantitySpec&, QuantityHistory& sum_and_count);
template <>
inline constexpr Computation computation<"wall-torque"> = mean_of<observe_wall_torque>;

}  // namespace silt::coupler
