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

/// Takes a share of what the trace of the second moments of populations is off its equilibrium, without a
/// force.
template <class T, class V>
SILT_DEVICE inline void give_up_bulk_stress(T share, V (&g)[directions]) {
  V off = -g[0], momentum[3]{};
  for_directions<1>([&](auto i) __attribute__((always_inline)) {
    if constexpr (i() % 2 == 1) {  // opposite ones follow each other
      if (i() >= 7) off += g[i()] + g[i() + 1];
      const V difference = g[i()] - g[i() + 1];
      constexpr Int3 v = c[i()];
      const auto push = [&](V & sum, int towards) __attribute__((always_inline)) {
        if (towards) sum = towards > 0 ? sum + difference : sum - difference;
      };
      push(momentum[0], v.x), push(momentum[1], v.y), push(momentum[2], v.z);
    }
  });
  for (int d = 0; d < 3; ++d) off -= momentum[d] * momentum[d];
  off *= share;
  g[0] += T(1. / 2) * off;
  for (int i = 7; i < directions; ++i) g[i] -= T(1. / 24) * off;
}

/// Takes an excess from the populations that arrive at a cell: three quarters of it from the one that rests,
/// the rest from all by their weights; and a share (CollisionSpec::bulk_stress_given_up) of what the second
/// moments' trace then is off its equilibrium. Without an excess the populations keep their bits. V: a
/// number, or a vector of cells.
template <class T, class V>
SILT_DEVICE inline void give_up_excess(const V& quanta, T stress_share, V (&g)[directions]) {
  constexpr double quantum = excess_quantum<T>, shares[] = {0.75 + w(0) / 4, w(1) / 4, w(7) / 4};
  const V excess = quanta * T(quantum);
  V left[directions] = {g[0] - T(shares[0]) * excess};
  const V axis = T(shares[1]) * excess, diagonal = T(shares[2]) * excess;
  for (int i = 1; i < directions; ++i) left[i] = g[i] - (i < 7 ? axis : diagonal);
  if (stress_share != 0) give_up_bulk_stress<T>(stress_share, left);
  for (int i = 0; i < directions; ++i) g[i] = quanta != V{} ? left[i] : g[i];
}

/// Takes a cell's excess from the populations g(i) that arrive at it.
template <class T, class Populations>
SILT_DEVICE inline void take_excess(ExcessQuanta<T>& excess, T stress_share, Populations&& g) {
  if (excess == 0) return;
  T left[directions];
  for (int i = 0; i < directions; ++i) left[i] = g(i);
  give_up_excess<T>(T(excess), stress_share, left);
  for (int i = 0; i < directions; ++i) g(i) = left[i];
  excess = 0;
}

}  // namespace silt::lbm
