// The dense pass of the temperature, built once per instruction set (SILT_BUILD): 7 reads and 7 writes per
// cell and step, and 18 reads of populations of the fluid, which its own pass reads next.
#include "lbm/heat/carry_heat.hpp"

#include "cpu/lanes.hpp"
#include "lbm/collision/cell_velocity.hpp"
#include "lbm/collision/rows.hpp"

namespace silt::lbm::SILT_BUILD {
namespace {

/// The slots of the populations that arrive at cell 0 of both lattices.
template <class T>
struct ArrivingSlots {
  T* heat[D3Q7::directions];
  const T* fluid[D3Q19::directions];
};

/// Collides the vector of cells from x on; lanes outside the row keep their values.
template <class V, class T, class Keep>
[[gnu::always_inline]] inline void carry(const ArrivingSlots<T>& slots, std::ptrdiff_t x,
                                         const HeatRates<T>& r, const Keep& keep) {
  const V rest = load<V>(slots.heat[0] + x);
  V along[3], against[3], u[3];
  for (int k = 0; k < 3; ++k)
    along[k] = load<V>(slots.heat[2 * k + 1] + x), against[k] = load<V>(slots.heat[2 * k + 2] + x);
  const V t = ((along[0] + against[0]) + (along[1] + against[1])) + ((along[2] + against[2]) + rest);
  V difference[D3Q19::pairs];
  for (int k = 0; k < D3Q19::pairs; ++k)
    difference[k] = load<V>(slots.fluid[2 * k + 1] + x) - load<V>(slots.fluid[2 * k + 2] + x);
  set_velocity<true>(difference, r, u[0], u[1], u[2]);
  V square{}, stream{}, flux[3];
  for (int d = 0; d < 3; ++d) {
    u[d] += r.half_buoyancy[d] * t;
    flux[d] = (along[d] - against[d]) - u[d] * t;
    square += u[d] * u[d], stream += u[d] * flux[d];
  }
  const V share = r.along * stream / (r.quarter - T(0.5) * square);
  // Relaxed by what populations lack, which is zero at equilibrium: rounding then adds no heat step after
  // step.
  store(slots.heat[0] + x, keep(V(rest + r.even * (T(D3Q7::w(0)) * t - rest)), rest));
  for (int k = 0; k < 3; ++k) {
    const V mean = T(0.5) * (along[k] + against[k]);
    const V p = mean + r.even * (T(D3Q7::w(1)) * t - mean);
    const V q = T(0.5) * ((along[k] - against[k]) - r.odd * (flux[k] - share * u[k]));
    store(slots.heat[2 * k + 1] + x, keep(V(p - q), along[k]));
    store(slots.heat[2 * k + 2] + x, keep(V(p + q), against[k]));
  }
}

template <class T>
void carry_rows(Block<T, D3Q7>& heat, const Block<T>& fluid, Parity parity, const HeatRates<T>& given,
                RowRange range) {
  using V = typename VectorOf<T>::type;
  constexpr int width = vector_bytes / sizeof(T);
  const HeatRates<T> rates = given;
  const int nx = heat.size().x, whole = nx / width * width;
  const FirstLanes<V, T> rest_of_row(nx % width);
  for (int z = range.z0; z < range.z1; ++z)
    for (int y = range.y0; y < range.y1; ++y) {
      const std::ptrdiff_t first = heat.cell(0, y, z), first_of_fluid = fluid.cell(0, y, z);
      ArrivingSlots<T> slots;
      for (int i = 0; i < D3Q7::directions; ++i)
        slots.heat[i] = heat.data() + heat.arriving(i, parity) + first;
      for (int i = 0; i < D3Q19::directions; ++i)
        slots.fluid[i] = fluid.data() + fluid.arriving(i, parity) + first_of_fluid;
      for (int x = 0; x < whole; x += width) carry<V>(slots, x, rates, AllLanes{});
      if (whole < nx) carry<V>(slots, whole, rates, rest_of_row);
      close_row(heat.data() + first, heat.row_ends(parity));
    }
}

}  // namespace

template <class T>
CarryHeat<T> carry_heat() {
  return carry_rows<T>;
}
template CarryHeat<float> carry_heat();
template CarryHeat<double> carry_heat();

}  // namespace silt::lbm::SILT_BUILD
