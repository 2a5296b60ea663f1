#pragma once
// The dense pass of the temperature (method-heat.md, equations H1 to H3).
#include "cpu/isa.hpp"
#include "lbm/blocks/block.hpp"
#include "lbm/heat/heat_rates.hpp"

namespace silt::lbm {

/// Collides rows of the temperature in place, with the velocities that the fluid has before its own pass over
/// these rows. Both blocks are of one box and at `parity`; that of the temperature is at the flipped one when
/// all rows are done.
template <class T>
using CarryHeat = void (*)(Block<T, D3Q7>&, const Block<T>& fluid, Parity, const HeatRates<T>&, RowRange);
SILT_BUILDS(template <class T> CarryHeat<T> carry_heat();)

}  // namespace silt::lbm
