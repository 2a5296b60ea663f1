#pragma once
// The share of a box that lies inside bodies: exact of a convex body all inside, else along lines through the
// box, and by points where a shape has no convex parts.
#include "coupler/results/quantity_computation.hpp"

namespace silt::coupler {

double packing_fraction(const Simulation&, const QuantitySpec&);
template <>
inline constexpr Computation computation<"packing-fraction"> = at_end<packing_fraction>;

}  // namespace silt::coupler
