#pragma once
// Quantities of a bed in a round container, from the places of its bodies. Meanings:
// coupler/case/quantity_spec.hpp.
#include "coupler/results/quantity_computation.hpp"

namespace silt::coupler {

/// Adds mass times the place of the bodies' centres from `centre`.
bool add_moment(const Simulation&, const QuantitySpec&, const QuantityHistory&, std::span<rigid::ExactSum>);
double bed_angle(const Case&, const QuantitySpec&, std::span<const double> moment);
template <>
inline constexpr Computation computation<"bed-angle"> = mean_of<3, add_moment, bed_angle>;

/// Adds the same of the mass that weighs: less that of the fluid displaced, and of free bodies only.
bool add_weighing_moment(const Simulation&, const QuantitySpec&, const QuantityHistory&,
                         std::span<rigid::ExactSum>);
double weight_torque(const Case&, const QuantitySpec&, std::span<const double> moment);
template <>
inline constexpr Computation computation<"weight-torque"> = mean_of<3, add_weighing_moment, weight_torque>;

}  // namespace silt::coupler
