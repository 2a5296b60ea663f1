#pragma once
// The excess of a cell: what its cut links gave it beyond the mass that the motion of their walls carries
// (method.md, equation 9a). A wall passes that mass and nothing else, so the cell gives the excess up when it
// collides next. Several links, of several surfaces, add to the excess of one cell, in any order: it is a
// whole number of quanta.
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

/// The parts of an excess in the populations that arrive at a cell, by their weights: in the one that rests,
/// and in each along an axis and along a diagonal. Without an excess a population less its part keeps its
/// bits.
template <class V, class T>
struct ExcessParts {
  V rest, axis, diagonal;
  SILT_DEVICE explicit ExcessParts(const V& quanta) {
    constexpr double quantum = excess_quantum<T>, of_rest = w(0), of_axis = w(1), of_diagonal = w(7);
    const V excess = quanta * T(quantum);
    rest = T(of_rest) * excess, axis = T(of_axis) * excess, diagonal = T(of_diagonal) * excess;
  }
  /// Returns population i without its part.
  SILT_DEVICE V taken_from(int i, const V& arriving) const {
    return arriving - (i == 0 ? rest : i < 7 ? axis : diagonal);
  }
};

/// Takes a cell's excess from the populations g(i) that arrive at it.
template <class T, class Populations>
SILT_DEVICE inline void take_excess(ExcessQuanta<T>& excess, Populations&& g) {
  if (excess == 0) return;
  const ExcessParts<T, T> parts{T(excess)};
  for (int i = 0; i < directions; ++i) g(i) = parts.taken_from(i, g(i));
  excess = 0;
}

}  // namespace silt::lbm
