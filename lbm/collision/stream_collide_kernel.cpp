// The dense pass, built once per instruction set (SILT_BUILD): 19 reads and 19 writes per cell and step.
#include <algorithm>

#include "cpu/lanes.hpp"
#include "lbm/collision/carry_heat.hpp"
#include "lbm/collision/rows.hpp"
#include "lbm/collision/stream_collide.hpp"

namespace silt::lbm::SILT_BUILD {
namespace {

/// Values for all rows of a pass; each run of planes takes a copy, which its loop keeps in registers.
template <class T, class Rates>
struct Pass {
  Block<T>& block;
  Parity parity;
  Rates rates;
  Slots<T> slots;
  FirstLanes<typename VectorOf<T>::type, T> rest_of_row;
};

/// Subtracts the excess of a cell from its populations.
template <class T>
void take_excess_of_cell(const Slots<T>& slots, std::ptrdiff_t cell, Block<T>& block) {
  take_excess<T>(block.excess()[cell], block.stress_share(),
                 [&](int i) -> T& { return slots.arriving(i)[cell]; });
}

/// Does so for all cells of a block.
template <class T>
void take_excess_of_block(Block<T>& block, Parity parity) {
  constexpr int width = Lanes<T>::count;
  const Slots<T> slots(block, parity);
  for (int z = 0; z < block.size().z; ++z)
    for (int y = 0; y < block.size().y; ++y) {
      if (!block.has_excess(y, z)) continue;
      std::ptrdiff_t x = block.cell(0, y, z);
      const std::ptrdiff_t end = x + block.size().x;
      for (; x + width <= end; x += width)
        take_excess_of_cells(slots, x, block.excess(), block.stress_share());
      for (; x < end; ++x) take_excess_of_cell(slots, x, block);
    }
}

/// Sets the excess of a vector of cells to zero; returns what they give up with it.
template <class T, class Keep, class V = typename VectorOf<T>::type>
[[gnu::always_inline]] inline GivenUp<V> excess_taken(Block<T>& block, const Slots<T>& slots,
                                                      std::ptrdiff_t x, const Keep& keep) {
  ExcessQuanta<T>* const excess = block.excess() + x;
  constexpr QuantaLanes<T> none{};
  const auto quanta = load<QuantaLanes<T>>(excess);
  store(excess, keep(none, quanta));
  return given_up<T>(converted<V>(keep(quanta, none)), block.stress_share(),
                     [&](int i) { return load<V>(slots.arriving(i) + x); });
}

/// Collides rows whose cells have an excess, or none. `watch` receives the cells' squared speeds and offsets.
template <class Model, bool source, bool with_excess, class T, class Pass, class Watch>
[[gnu::noinline]] void rows(const Pass pass, RowRange range, const Watch& watch) {
  using V = typename VectorOf<T>::type;
  constexpr int width = vector_bytes / sizeof(T);
  const int nx = pass.block.size().x, whole = nx / width * width;
  const auto collide_at = [&](std::ptrdiff_t x, const auto& keep) __attribute__((always_inline)) {
    if constexpr (with_excess)
      collide<Model, source, V>(pass.slots, x, pass.rates, keep, watch,
                                excess_taken(pass.block, pass.slots, x, keep));
    else
      collide<Model, source, V>(pass.slots, x, pass.rates, keep, watch);
  };
  for (int z = range.z0; z < range.z1; ++z)
    for (int y = range.y0; y < range.y1; ++y) {
      const std::ptrdiff_t first = pass.block.cell(0, y, z), end = first + whole;
      for (std::ptrdiff_t x = first; x < end; x += width) collide_at(x, AllLanes{});
      if (whole < nx) collide_at(end, pass.rest_of_row);
      pass.block.close_row(first, pass.parity);
      if (auto* const carried = pass.block.temperature()) carried->close_row(first, pass.parity);
    }
}

/// Collides runs of rows with an excess, and of rows without.
template <class Model, bool source, class T, class Pass, class Watch>
void linked_rows(const Pass& pass, RowRange range, const Watch& watch) {
  for (int z = range.z0; z < range.z1; ++z)
    for (int y = range.y0, end; y < range.y1; y = end) {
      const bool excess = pass.block.has_excess(y, z);
      for (end = y + 1; end < range.y1 && pass.block.has_excess(end, z) == excess;) ++end;
      if (excess)
        rows<Model, source, true, T>(pass, {y, end, z, z + 1}, watch);
      else
        rows<Model, source, false, T>(pass, {y, end, z, z + 1}, watch);
    }
}

/// Separates watched planes from the others, since watching takes registers. `linked`: cells of the block may
/// have links.
template <class Model, bool source, bool linked, class T, class Pass>
void planes(const Pass& pass, RowRange range, const WatchedPlanes& watched) {
  const T scale = Model::square_scale(pass.rates.fluid);
  const auto note = [&](std::ptrdiff_t cell, double speed) { watched.found.push_back({cell, speed}); };
  const Watch<T, decltype(note)> watch{T(speed_of_sound * speed_of_sound) * scale, scale, note};
  const auto collide_planes = [&](int z, int end, const auto& seen) {
    const RowRange of_planes{range.y0, range.y1, z, end};
    if constexpr (linked)
      linked_rows<Model, source, T>(pass, of_planes, seen);
    else
      rows<Model, source, false, T>(pass, of_planes, seen);
  };
  for (int z = range.z0; z < range.z1;) {
    const int plane = std::min(watched.next(z), range.z1);
    if (z < plane) collide_planes(z, plane, Unseen());
    if (plane < range.z1) collide_planes(plane, plane + 1, watch);
    z = plane + 1;
  }
}

template <class Model, class T>
void rows_under(Block<T>& block, Parity parity, const CollisionRates<T>& rates, RowRange range,
                const WatchedPlanes& watched) {
  using V = typename VectorOf<T>::type;
  with_rates(rates, block, parity,
             [&]<bool source, class Rates>(std::bool_constant<source>, const Rates& of) {
               const Pass<T, Rates> pass{block,
                                         parity,
                                         of,
                                         {block, parity},
                                         FirstLanes<V, T>(block.size().x % int(sizeof(V) / sizeof(T)))};
               if (block.excess())
                 planes<Model, source, true, T>(pass, range, watched);
               else
                 planes<Model, source, false, T>(pass, range, watched);
             });
}

}  // namespace

template <class T>
CollideRows<T> collide_rows(const CollisionRates<T>& rates) {
  return with_model(rates, []<class Model>(Model) -> CollideRows<T> { return rows_under<Model, T>; });
}
template <class T>
TakeExcess<T> excess_kernel() {
  return take_excess_of_block<T>;
}
template CollideRows<float> collide_rows(const CollisionRates<float>&);
template CollideRows<double> collide_rows(const CollisionRates<double>&);
template TakeExcess<float> excess_kernel();
template TakeExcess<double> excess_kernel();

}  // namespace silt::lbm::SILT_BUILD
