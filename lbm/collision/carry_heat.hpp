#pragma once
// The rates of a vector of cells, found between the loads of their collision and its arithmetic, where the
// temperature collides that the fluid carries: 7 reads and 7 writes per cell and step. Only for files built
// for a device or an instruction set (SILT_BUILD).
#include "cpu/lanes.hpp"
#include "lbm/blocks/block.hpp"
#include "lbm/collision/cell_velocity.hpp"
#include "lbm/collision/collide_cells.hpp"
#include "lbm/collision/heat_rates.hpp"

namespace silt::lbm::SILT_BUILD {

/// Rates with a force of its own on each of a vector of cells.
template <class T, class V>
struct BuoyantRates : CollisionRates<T> {
  V half_force[3], even_force[3], odd_force[3];
  [[gnu::always_inline]] SILT_DEVICE BuoyantRates(const CollisionRates<T>& r, const HeatRates<T>& of_one,
                                                  const V& temperature)
      : CollisionRates<T>(r) {
    for (int d = 0; d < 3; ++d) {
      half_force[d] = r.half_force[d] + of_one.half_force[d] * temperature;
      even_force[d] = r.even_force[d] + of_one.even_force[d] * temperature;
      odd_force[d] = r.odd_force[d] + of_one.odd_force[d] * temperature;
    }
  }
};

/// Collides the temperature (method-heat.md, equations H1 to H3, with a gradient H9) and returns the rates of
/// the fluid under its buoyancy (H8). Both lattices have the same cells at the same offsets.
template <class T, bool has_gradient>
struct CarryHeat {
  CollisionRates<T> fluid;
  HeatRates<T> heat;
  T* slots[D3Q7::directions];  // of the populations that arrive at cell 0

  CarryHeat(const CollisionRates<T>& fluid, Block<T, D3Q7>& block, Parity parity)
      : fluid(fluid), heat(*fluid.heat) {
    for (int i = 0; i < D3Q7::directions; ++i) slots[i] = block.data() + block.arriving(i, parity);
  }

  /// Takes the differences of the pairs of the fluid. Lanes outside the row keep their values.
  template <class V, class Keep>
  [[gnu::always_inline]] SILT_DEVICE BuoyantRates<T, V> at(std::ptrdiff_t x,
                                                           const V (&difference)[D3Q19::pairs],
                                                           const Keep& keep) const {
    constexpr Prefetch prefetch;
    for (T* const slot : slots) prefetch(slot + x);
    const V rest = load<V>(slots[0] + x);
    V along[3], against[3], u[3];
    for (int k = 0; k < 3; ++k)
      along[k] = load<V>(slots[2 * k + 1] + x), against[k] = load<V>(slots[2 * k + 2] + x);
    const V t = ((along[0] + against[0]) + (along[1] + against[1])) + ((along[2] + against[2]) + rest);
    const BuoyantRates<T, V> rates(fluid, heat, t);
    set_velocity<true>(difference, rates, u[0], u[1], u[2]);
    V square{}, stream{}, flux[3];
    for (int d = 0; d < 3; ++d) {
      flux[d] = (along[d] - against[d]) - u[d] * t;
      square += u[d] * u[d], stream += u[d] * flux[d];
    }
    V source{};
    if constexpr (has_gradient)
      for (int d = 0; d < 3; ++d) source -= heat.gradient[d] * u[d];
    const V share = heat.along * stream / (heat.quarter - T(0.5) * square);
    // Relaxed by what populations lack, which is zero at equilibrium: rounding then adds no heat step after
    // step.
    V left = rest + heat.even * (T(D3Q7::w(0)) * t - rest);
    if constexpr (has_gradient) left += T(D3Q7::w(0)) * source;
    store(slots[0] + x, keep(left, rest));
    for (int k = 0; k < 3; ++k) {
      const V mean = T(0.5) * (along[k] + against[k]);
      V p = mean + heat.even * (T(D3Q7::w(1)) * t - mean);
      if constexpr (has_gradient) p += T(D3Q7::w(1)) * source;
      const V q = T(0.5) * ((along[k] - against[k]) - heat.odd * (flux[k] - share * u[k]));
      store(slots[2 * k + 1] + x, keep(V(p - q), along[k]));
      store(slots[2 * k + 2] + x, keep(V(p + q), against[k]));
    }
    return rates;
  }
};

/// The rates of fluid that carries nothing.
template <class T>
struct SameRates {
  CollisionRates<T> fluid;
  template <class V, class Keep>
  [[gnu::always_inline]] SILT_DEVICE const CollisionRates<T>& at(std::ptrdiff_t, const V (&)[D3Q19::pairs],
                                                                 const Keep&) const {
    return fluid;
  }
};

/// Calls f(source, rates), by the force on the cells of a block and what it carries.
template <class T, class F>
void with_rates(const CollisionRates<T>& rates, Block<T>& block, Parity parity, F&& f) {
  const auto call = [&](bool source, const auto& of) {
    if (source)
      f(std::true_type(), of);
    else
      f(std::false_type(), of);
  };
  if (rates.heat && rates.heat->has_gradient())
    f(std::true_type(), CarryHeat<T, true>(rates, *block.temperature(), parity));
  else if (rates.heat)
    call(rates.has_force() || rates.heat->has_force(),
         CarryHeat<T, false>(rates, *block.temperature(), parity));
  else
    call(rates.has_force(), SameRates<T>{rates});
}

}  // namespace silt::lbm::SILT_BUILD
