#pragma once
// Quantities that look at the fluid. Meanings: coupler/case/quantity_spec.hpp.
#include "coupler/results/quantity_computation.hpp"

namespace silt::coupler {

double drag_coefficient(const Simulation&, const QuantitySpec&);
template <>
inline constexpr Computation computation<"drag-coefficient"> = at_end<drag_coefficient>;

double superficial_velocity(const Simulation&, const QuantitySpec&);
template <>
inline constexpr Computation computation<"superficial-velocity"> = at_end<superficial_velocity>;

double profile_error(const Simulation&, const QuantitySpec&);
template <>
inline constexpr Computation computation<"profile-error"> = at_end<profile_error>;

double vortex_velocity_error(const Simulation&);
template <>
inline constexpr Computation computation<"taylor-green-velocity"> = at_end<vortex_velocity_error>;

double vortex_decay_error(const Simulation&);
template <>
inline constexpr Computation computation<"taylor-green-decay"> = at_end<vortex_decay_error>;

double kinetic_energy(const Simulation&);
template <>
inline constexpr Computation computation<"kinetic-energy"> = at_instant<kinetic_energy>;

double dissipation(const Simulation&);
template <>
inline constexpr Computation computation<"dissipation"> = at_instant<dissipation>;

}  // namespace silt::coupler
