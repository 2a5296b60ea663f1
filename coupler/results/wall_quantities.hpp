#pragma once
// Quantities that look at what fluid and bodies do to the walls; means over the steps from a time on. The
// force of contacts is that of the last sub-step of each step. Meanings: coupler/case/quantity_spec.hpp.
#include "coupler/results/quantity_computation.hpp"

namespace silt::coupler {

double axis_distance(const Simulation&, const QuantitySpec&);
template <>
inline constexpr Computation computation<"axis-distance"> = at_end<axis_distance>;

bool add_wall_stress(const Simulation&, const QuantitySpec&, const QuantityHistory&,
                     std::span<rigid::ExactSum> force);
double wall_stress(const Case&, const QuantitySpec&, std::span<const double> force);
template <>
inline constexpr Computation computation<"wall-stress"> = mean_of<3, add_wall_stress, wall_stress>;

/// The force on the lower side across the axis less that on the upper one.
bool add_shear_resistance(const Simulation&, const QuantitySpec&, const QuantityHistory&,
                          std::span<rigid::ExactSum> resistance);
double relative_viscosity(const Case&, const QuantitySpec&, std::span<const double> resistance);
template <>
inline constexpr Computation computation<"relative-viscosity"> =
    mean_of<3, add_shear_resistance, relative_viscosity>;

bool add_wall_force(const Simulation&, const QuantitySpec&, const QuantityHistory&,
                    std::span<rigid::ExactSum> force);
double wall_force(const Case&, const QuantitySpec&, std::span<const double> force);
template <>
inline constexpr Computation computation<"wall-force"> = mean_of<3, add_wall_force, wall_force>;

/// Force, and torque about the origin of the wall's frame.
bool add_wall_load(const Simulation&, const QuantitySpec&, const QuantityHistory&,
                   std::span<rigid::ExactSum> load);
double wall_torque(const Case&, const QuantitySpec&, std::int64_t step, std::span<const double> load);
template <>
inline constexpr Computation computation<"wall-torque"> = mean_of<6, add_wall_load, wall_torque>;

double wall_power(const Case&, const QuantitySpec&, std::int64_t step, std::span<const double> load);
template <>
inline constexpr Computation computation<"wall-power"> = mean_of<6, add_wall_load, wall_power>;

}  // namespace silt::coupler
