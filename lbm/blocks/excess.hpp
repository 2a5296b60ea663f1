#pragma once
// The excess of a cell: the mass that its cut links gave it beyond the mass that the motion of the walls
// carries (method.md, equation 9a). A wall passes only the latter, so the cell gives up the excess at its
// next collision. Several links add to a cell's excess in any order: it is a whole number of quanta.
#include <cstdint>
#include <type_traits>

#include "cpu/device_code.hpp"
#include "lbm/blocks/lattice.hpp"

namespace silt::lbm {

/// Excess in quanta, below 1/2 in single precision and 2^13 in double; a link adds less than 1/4, or 2.
template <class T>
using ExcessQuanta = std::conditional_t<sizeof(T) == 4, std::int32_t, std::int64_t>;
template <class T>
inline constexpr double excess_quantum = sizeof(T) == 4 ? 0x1p-32 : 0x1p-50;

/// The amounts that the populations arriving at a cell give up. V is a number or a vector of cells.
template <class V>
struct GivenUp {
  V rest, axis, diagonal;  // by the population at rest, each along an axis, each along a diagonal
  SILT_DEVICE V left(int i, const V& g) const { return g - (i == 0 ? rest : i < 7 ? axis : diagonal); }
};

/// Returns the trace of the second moments of g(i) less that of the equilibrium without a force.
template <class V, class Populations>
SILT_DEVICE inline V bulk_stress(Populations&& g) {
  V off = -g(0), momentum[3]{};
  for_directions<D3Q19, 1>([&](auto i) __attribute__((always_inline)) {
    if constexpr (i() % 2 == 1) {  // opposites are neighbours
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

/// Returns the amounts that cells give up of the populations g(i) that arrive: three quarters of the excess
/// from the population at rest, the rest from all by their weights, and then a share
/// (CollisionSpec::bulk_stress_given_up) of the bulk stress that is left. Returns zero without an excess.
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

/// Subtracts a cell's excess from the populations g(i) that arrive at it, and sets it to zero.
template <class T, class Populations>
SILT_DEVICE inline void take_excess(ExcessQuanta<T>& excess, T stress_share, Populations&& g) {
  if (excess == 0) return;
  const GivenUp<T> given = given_up<T>(T(excess), stress_share, g);
  for (int i = 0; i < D3Q19::directions; ++i) g(i) = given.left(i, g(i));
  excess = 0;
}

}  // namespace silt::lbm
