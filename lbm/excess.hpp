#pragma once
// The excess of a cell: what its cut links took from it beyond the mass that the motion of their walls carries
// (method.md, equation 9a). A wall passes that mass and nothing else, so the cell gets the excess back when it
// collides next. Several links, of several surfaces, add to the excess of one cell,
// in any order: it is a whole number of quanta.
#include <cstdint>
#include <type_traits>

#include "cpu/device_code.hpp"
#include "lbm/lattice.hpp"

namespace silt::lbm {

/// In single precision an excess is below 1/2, in double below 2^13; a link adds less than 1/4, or 2.
template <class T>
using ExcessQuanta = std::conditional_t<sizeof(T) == 4, std::int32_t, std::int64_t>;
template <class T>
inline constexpr double excess_quantum = sizeof(T) == 4 ? 0x1p-32 : 0x1p-50;

/// Gives a cell's excess to the populations g(i) that arrive at it, by their weights, and calls it settled.
template <class T, class Populations>
SILT_DEVICE inline void take_up_excess(ExcessQuanta<T>& excess, Populations&& g) {
  if (excess == 0) return;
  const T density = T(excess) * T(excess_quantum<T>);
  for (int i = 0; i < directions; ++i) g(i) += T(w(i)) * density;
  excess = 0;
}

}  // namespace silt::lbm
