// The dense pass, built once an instruction set (SILT_ISA). A cell takes 19 reads and 19 writes a step.
#include <algorithm>
#include <cmath>

#include "cpu/lanes.hpp"
#include "lbm/collide_cells.hpp"
#include "lbm/stream_collide.hpp"

namespace silt::lbm::SILT_ISA {
namespace {

/// The lanes of a vector that are cells: the first `cells`.
template <class V, class T>
struct FirstLanes {
  static constexpr int count = sizeof(V) / sizeof(T);
  decltype(V{} < V{}) inside;
  explicit FirstLanes(std::ptrdiff_t cells) {
    V lane;
    for (int i = 0; i < count; ++i) lane[i] = T(i);
    inside = lane < (V{} + T(cells));
  }
  V operator()(const V& inner, const V& outer) const { return inside ? inner : outer; }
};
/// Notes the cells that are too fast, or whose speed is not a number. Where there is none, which is as good
/// as always, it takes a comparison and a branch.
template <class V, class T>
struct Watch {
  T limit, scale;  // of the model's squares; what they are times the speeds'
  std::vector<FastCell>& found;
  template <class Keep>
  [[gnu::always_inline]] void see(const V& square, std::ptrdiff_t x, const Keep& keep) {
    const V seen = keep(square, V{});
    if (any_lane(!(seen <= V{} + limit))) [[unlikely]]
      note(seen, x);
  }
  [[gnu::noinline, gnu::cold]] void note(const V seen, std::ptrdiff_t x) {
    for (int i = 0; i < int(sizeof(V) / sizeof(T)); ++i)
      if (!(seen[i] <= limit)) found.push_back({x + i, std::sqrt(double(seen[i]) / double(scale))});
  }
};
struct Unseen {
  template <class V, class Keep>
  [[gnu::always_inline]] void see(const V&, std::ptrdiff_t, const Keep&) {}
};

template <class T>
inline void close_row(T* first, const std::vector<RowEnd<T>>& ends) {
  for (const RowEnd<T>& end : ends) first[end.to] = end.wall ? first[end.from] + end.addend : first[end.from];
}

/// All rows of a pass need these values; each run of planes has a copy, which its loop keeps at hand.
template <class T>
struct Pass {
  Block<T>& block;
  Parity parity;
  CollisionRates<T> rates;
  Slots<T> slots;
  FirstLanes<typename VectorOf<T>::type, T> rest_of_row;
};

/// The cells of a row, the first of which is Block::cell `first`, take up their excess: whole vectors with the
/// bits of single cells.
template <class T>
[[gnu::noinline]] void take_up_excess(const Slots<T>& slots, std::ptrdiff_t first, ExcessQuanta<T>* excess,
                                      int cells) {
  using V = typename VectorOf<T>::type;
  constexpr int width = vector_bytes / sizeof(T);
  using Quanta = typename VectorOf<ExcessQuanta<T>, width>::type;
  int x = 0;
  for (; x + width <= cells; x += width) {
    const Quanta quanta = load<Quanta>(excess + x);
    if (!any_lane(quanta != Quanta{})) continue;
    const V density = __builtin_convertvector(quanta, V) * T(excess_quantum<T>);
    const auto add = [&](T* slot, int i) __attribute__((always_inline)) {
      const V g = load<V>(slot + first + x);
      store(slot + first + x, density != V{} ? V(g + T(w(i)) * density) : g);
    };
    add(slots.rest, 0);
    for (int k = 0; k < pairs; ++k) add(slots.a[k], 2 * k + 1), add(slots.b[k], 2 * k + 2);
    store(excess + x, Quanta{});
  }
  for (; x < cells; ++x)
    lbm::take_up_excess<T>(excess[x], [&](int i) -> T& { return slots.arriving(i)[first + x]; });
}

/// `watch` sees the cells' squares and where they are.
template <class Model, bool source, class T, class Watch>
[[gnu::noinline]] void row_range(const Pass<T> pass, RowRange range, Watch& watch) {
  using V = typename VectorOf<T>::type;
  constexpr int width = vector_bytes / sizeof(T);
  const int nx = pass.block.size().x, whole = nx / width * width;
  for (int z = range.z0; z < range.z1; ++z)
    for (int y = range.y0; y < range.y1; ++y) {
      const std::ptrdiff_t first = pass.block.cell(0, y, z), end = first + whole;
      if (ExcessQuanta<T>* const excess = pass.block.excess_of_row(y, z))
        take_up_excess(pass.slots, first, excess, nx);
      for (std::ptrdiff_t x = first; x < end; x += width)
        collide<Model, source, V>(pass.slots, x, pass.rates, AllLanes{}, watch);
      if (whole < nx) collide<Model, source, V>(pass.slots, end, pass.rates, pass.rest_of_row, watch);
      close_row(pass.block.data() + first, pass.block.row_ends(pass.parity));
    }
}

/// Planes apart from each other: to see anything takes registers.
template <class Model, bool source, class T>
void planes(Block<T>& block, Parity parity, const CollisionRates<T>& rates, RowRange range,
            const WatchedPlanes& watched) {
  using V = typename VectorOf<T>::type;
  const Pass<T> pass{
      block, parity, rates, {block, parity}, FirstLanes<V, T>(block.size().x % int(sizeof(V) / sizeof(T)))};
  const T scale = Model::square_scale(rates);
  Watch<V, T> watch{T(speed_of_sound * speed_of_sound) * scale, scale, watched.found};
  Unseen unseen;
  for (int z = range.z0; z < range.z1;) {
    const int plane = std::min(watched.next(z), range.z1);
    if (z < plane) row_range<Model, source>(pass, {range.y0, range.y1, z, plane}, unseen);
    if (plane < range.z1) row_range<Model, source>(pass, {range.y0, range.y1, plane, plane + 1}, watch);
    z = plane + 1;
  }
}

template <class Model, class T>
void rows_under(Block<T>& block, Parity parity, const CollisionRates<T>& rates, RowRange range,
                const WatchedPlanes& watched) {
  if (rates.has_force())
    planes<Model, true>(block, parity, rates, range, watched);
  else
    planes<Model, false>(block, parity, rates, range, watched);
}

}  // namespace

template <class T>
CollideRows<T> collide_rows(const CollisionRates<T>& rates) {
  return with_model(rates, []<class Model>(Model) -> CollideRows<T> { return rows_under<Model, T>; });
}
template CollideRows<float> collide_rows(const CollisionRates<float>&);
template CollideRows<double> collide_rows(const CollisionRates<double>&);

}  // namespace silt::lbm::SILT_ISA
