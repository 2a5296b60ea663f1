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

/// Takes an excess from the populations that arrive at a cell: half of it from the one that rests, half from
/// all by their weights; and what the second moments' trace then is off its equilibrium. Without an excess
/// the populations keep their bits. V: a number, or a vector of cells.
template <class T, class V>
SILT_DEVICE inline void give_up_excess(const V& quanta, V (&g)[directions]) {
  constexpr double quantum = excess_quantum<T>, shares[] = {0.5 + w(0) / 2, w(1) / 2, w(7) / 2};
  const V excess = quanta * T(quantum);
  const V rest = T(shares[0]) * excess, axis = T(shares[1]) * excess, diagonal = T(shares[2]) * excess;
  V left[directions] = {g[0] - rest}, off = -left[0], momentum[3]{};
  for_directions<1>([&](auto i) __attribute__((always_inline)) {
    if constexpr (i() % 2 == 1) {  // opposite ones follow each other
      const V& part = i() < 7 ? axis : diagonal;
      left[i()] = g[i()] - part, left[i() + 1] = g[i() + 1] - part;
      if (i() >= 7) off += left[i()] + left[i() + 1];
      const V difference = left[i()] - left[i() + 1];
      constexpr Int3 v = c[i()];
      const auto push = [&](V & sum, int towards) __attribute__((always_inline)) {
        if (towards) sum = towards > 0 ? sum + difference : sum - difference;
      };
      push(momentum[0], v.x), push(momentum[1], v.y), push(momentum[2], v.z);
    }
  });
  for (int d = 0; d < 3; ++d) off -= momentum[d] * momentum[d];
  left[0] += T(1. / 2) * off;
  for (int i = 7; i < directions; ++i) left[i] -= T(1. / 24) * off;
  for (int i = 0; i < directions; ++i) g[i] = quanta != V{} ? left[i] : g[i];
}

/// Takes a cell's excess from the populations g(i) that arrive at it.
template <class T, class Populations>
SILT_DEVICE inline void take_excess(ExcessQuanta<T>& excess, Populations&& g) {
  if (excess == 0) return;
  T left[directions];
  for (int i = 0; i < directions; ++i) left[i] = g(i);
  give_up_excess<T>(T(excess), left);
  for (int i = 0; i < directions; ++i) g(i) = left[i];
  excess = 0;
}

}  // namespace silt::lbm
