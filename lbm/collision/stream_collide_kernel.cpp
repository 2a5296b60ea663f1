// The dense pass, built once per instruction set (SILT_BUILD): 19 reads and 19 writes per cell and step.
#include <algorithm>
#include <cmath>
#include <utility>

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

/// Collides whole vectors from x to `end` of a row with excess, and takes the excess of the cells up to
/// `row_end`. Kept out of the loop over rows, where it would take registers.
template <class Model, bool source, class T, class Pass, class Watch>
[[gnu::noinline]] void collide_with_excess(const Pass& pass, std::ptrdiff_t x, std::ptrdiff_t end,
                                           std::ptrdiff_t row_end, const Watch& watch) {
  using V = typename VectorOf<T>::type;
  ExcessQuanta<T>* const excess = pass.block.excess();
  for (; x < end; x += vector_bytes / sizeof(T)) {
    const auto quanta = load<QuantaLanes<T>>(excess + x);
    if (!any_lane(quanta != QuantaLanes<T>{})) {
      collide<Model, source, V>(pass.slots, x, pass.rates, AllLanes{}, watch);
      continue;
    }
    const auto g = [&](int i) { return load<V>(pass.slots.arriving(i) + x); };
    const auto given = given_up<T>(converted<V>(quanta), pass.block.stress_share(), g);
    collide<Model, source, V>(pass.slots, x, pass.rates, AllLanes{}, watch, given);
    store(excess + x, QuantaLanes<T>{});
  }
  for (; x < row_end; ++x) take_excess_of_cell(pass.slots, x, pass.block);
}

/// `watch` receives the cells' squared speeds and offsets; `linked`: cells of the block may have links.
template <class Model, bool source, bool linked, class T, class Pass, class Watch>
[[gnu::noinline]] void row_range(const Pass pass, RowRange range, const Watch& watch) {
  using V = typename VectorOf<T>::type;
  constexpr int width = vector_bytes / sizeof(T);
  const int nx = pass.block.size().x, whole = nx / width * width;
  for (int z = range.z0; z < range.z1; ++z)
    for (int y = range.y0; y < range.y1; ++y) {
      const std::ptrdiff_t first = pass.block.cell(0, y, z), end = first + whole;
      std::ptrdiff_t x = first;
      if (linked && pass.block.has_excess(y, z))
        collide_with_excess<Model, source, T>(pass, std::exchange(x, end), end, first + nx, watch);
      for (; x < end; x += width) collide<Model, source, V>(pass.slots, x, pass.rates, AllLanes{}, watch);
      if (whole < nx) collide<Model, source, V>(pass.slots, end, pass.rates, pass.rest_of_row, watch);
      close_row(pass.block, first, pass.parity);
      if (auto* const carried = pass.block.temperature()) close_row(*carried, first, pass.parity);
    }
}

/// Separates watched planes from the others, since watching takes registers.
template <class Model, bool source, bool linked, class T, class Pass>
void planes(const Pass& pass, RowRange range, const WatchedPlanes& watched) {
  const T scale = Model::square_scale(pass.rates.fluid);
  const auto note = [&](std::ptrdiff_t cell, double speed) { watched.found.push_back({cell, speed}); };
  const Watch<T, decltype(note)> watch{T(speed_of_sound * speed_of_sound) * scale, scale, note};
  const Unseen unseen;
  for (int z = range.z0; z < range.z1;) {
    const int plane = std::min(watched.next(z), range.z1);
    if (z < plane) row_range<Model, source, linked, T>(pass, {range.y0, range.y1, z, plane}, unseen);
    if (plane < range.z1)
      row_range<Model, source, linked, T>(pass, {range.y0, range.y1, plane, plane + 1}, watch);
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
