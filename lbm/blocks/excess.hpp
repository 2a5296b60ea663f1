#pragma once
// The excess of a cell: what its cut links gave it beyond the mass that the motion of their walls carries
// (method.md, equation 9a). A wall passes that mass and nothing else, so the cell gives the excess up when it
// collides next. Several links, of several surfaces, add to the excess of one cell, in any order: it is a
// whole number of quanta.
#include <cstdint>
#include <type_traits>

#include "cpu/device_code.hpp"
#include "lbm/blocks/lattice.hpp"

namespace silt::lbm {

/// In single precision an excess is below 1/2, in double below 2^13; a link adds less than 1/4, or 2.
template <class T>
using ExcessQuanta = std::conditional_t<sizeof(T) == 4, std::int32_t, std::int64_t>;
template <class T>
inline constexpr double excess_quantum = sizeof(T) == 4 ? 0x1p-32 : 0x1p-50;

/// What the populations that arrive at a cell give up. V: a number, or a vector of cells.
template <class V>
struct GivenUp {
  V rest, axis, diagonal;  // by each population that rests, or moves along an axis or a diagonal
  SILT_DEVICE V left(int i, const V& g) const { return g - (i == 0 ? rest : i < 7 ? axis : diagonal); }
};

/// Returns what the trace of the second moments of populations g(i) is off its equilibrium, without a force.
template <class V, class Populations>
SILT_DEVICE inline V bulk_stress(Populations&& g) {
  V off = -g(0), momentum[3]{};
  for_directions<D3Q19, 1>([&](auto i) __attribute__((always_inline)) {
    if constexpr (i() % 2 == 1) {  // opposite ones follow each other
      const V a = g(i()), b = g(i() + 1), difference = a - b;
      if (i() >= 7) off += a + b;
      constexpr Int3 v = D3Q19::c[i()];
      const auto push = [&](V & sum, int towards) __attribute__((always_inline)) {
        if (towards) sum = towards > 0 ? sum + difference : sum - difference;
      };
      push(momentum[0], v.x), push(momentum[1], v.y), push(momentum[2], v.z);
    }
  });
  for (int d = 0; d < 3; ++d) off -= momentum[d] * momentum[d];
  return off;
}

/// Returns what cells with an excess take from the populations g(i) that arrive at them: three quarters of it
/// from the one that rests, the rest from all by their weights; and a share
/// (CollisionSpec::bulk_stress_given_up) of the bulk stress that is left then. Without an excess this is 0.
template <class T, class V, class Populations>
SILT_DEVICE inline GivenUp<V> given_up(const V& quanta, T stress_share, Populations&& g) {
  const V excess = quanta * T(excess_quantum<T>);
  GivenUp<V> all{T(0.75 + D3Q19::w(0) / 4) * excess, T(D3Q19::w(1) / 4) * excess,
                 T(D3Q19::w(7) / 4) * excess};
  if (stress_share == 0) return all;
  const V off = bulk_stress<V>([&](int i) { return all.left(i, g(i)); });
  const V taken = quanta != V{} ? V(stress_share * off) : V{};
  all.rest -= T(1. / 2) * taken, all.diagonal += T(1. / 24) * taken;
  return all;
}

/// Takes a cell's excess from the populations g(i) that arrive at it.
template <class T, class Populations>
SILT_DEVICE inline void take_excess(ExcessQuanta<T>& excess, T stress_share, Populations&& g) {
  if (excess == 0) return;
  const GivenUp<T> given = given_up<T>(T(excess), stress_share, g);
  for (int i = 0; i < D3Q19::directions; ++i) g(i) = given.left(i, g(i));
  excess = 0;
}

}  // namespace silt::lbm
