// The dense pass, built once an instruction set (SILT_ISA names the namespace). A cell takes 19 reads and 19
// writes a step.
//
// The populations of a pair i, opposite i that arrive at a cell lie in two slots A and B; what leaves along i
// goes to B and what leaves against it to A. Where A and B are is all that the parity decides, so one loop
// serves the even and the odd step.
#include <algorithm>
#include <cmath>

#include "cpu/lanes.hpp"
#include "cpu/prefetch.hpp"
#include "lbm/recursive_regularised_kernel.hpp"
#include "lbm/stream_collide.hpp"
#include "lbm/two_relaxation_times_kernel.hpp"

namespace silt::lbm::SILT_ISA {
namespace {

inline constexpr int prefetch_bytes = 512;  // best of 256 to 1536 for large blocks, 640 for 80^3

template <class T>
struct Slots {  // A and B of each pair, and the resting populations; a cell is Block::cell elements further
  T* a[pairs];
  T* b[pairs];
  T* rest;
  Slots(Block<T>& block, Parity parity) : rest(block.data() + block.slot(0)) {
    for (int k = 0; k < pairs; ++k) {
      a[k] = block.data() + block.arriving(2 * k + 1, parity);
      b[k] = block.data() + block.arriving(2 * k + 2, parity);
    }
  }
};

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
struct AllLanes {
  template <class V>
  const V& operator()(const V& inner, const V&) const {
    return inner;
  }
};

/// Fetches ahead of use, so that memory answers in time: the hardware's own streams are too few for nineteen
/// arrays.
struct Prefetch {
  template <class T>
  void operator()(const T* p) const {
    prefetch_to_write(p + prefetch_bytes / sizeof(T));
  }
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

/// Collides the cells from x on, as many as a vector has. Slots of lanes that are no cells keep what they
/// hold: no other lane of the vector has them.
template <class Model, bool source, class V, class T, class Keep, class Watch>
[[gnu::always_inline]] inline void collide(const Slots<T>& slots, std::ptrdiff_t x,
                                           const CollisionRates<T>& r, const Keep& keep, Watch& watch) {
  constexpr Prefetch prefetch;
  V sum[pairs + 1], difference[pairs];
  for (int k = 0; k < pairs; ++k) {
    const V a = load<V>(slots.a[k] + x), b = load<V>(slots.b[k] + x);
    prefetch(slots.a[k] + x);
    prefetch(slots.b[k] + x);
    sum[k] = a + b;
    difference[k] = a - b;
  }
  sum[pairs] = load<V>(slots.rest + x);
  prefetch(slots.rest + x);

  const auto set_rest = [&](const V& left) __attribute__((always_inline)) {
    store(slots.rest + x, keep(left, sum[pairs]));
  };
  const auto set_pair = [&](int k, const V& p, const V& q) __attribute__((always_inline)) {
    store(slots.a[k] + x, keep(V(p - q), load<V>(slots.a[k] + x)));
    store(slots.b[k] + x, keep(V(p + q), load<V>(slots.b[k] + x)));
  };
  const auto see = [&](const V& square) __attribute__((always_inline)) {
    watch.see(square, x, keep);
  };
  Model::template collide<source>(sum, difference, r, set_rest, set_pair, see);
}

template <class T>
inline void close_row(T* first, const std::vector<RowEnd<T>>& ends) {
  for (const RowEnd<T>& end : ends) first[end.to] = end.wall ? first[end.from] + end.addend : first[end.from];
}

/// What all rows of a pass need, copied into each run of planes: their loop keeps it at hand.
template <class T>
struct Pass {
  Block<T>& block;
  Parity parity;
  CollisionRates<T> rates;
  Slots<T> slots;
  FirstLanes<typename VectorOf<T>::type, T> rest_of_row;
};

/// `watch` sees the cells' squares and where they are.
template <class Model, bool source, class T, class Watch>
[[gnu::noinline]] void row_range(const Pass<T> pass, RowRange range, Watch& watch) {
  using V = typename VectorOf<T>::type;
  constexpr int width = vector_bytes / sizeof(T);
  const int nx = pass.block.size().x, whole = nx / width * width;
  for (int z = range.z0; z < range.z1; ++z)
    for (int y = range.y0; y < range.y1; ++y) {
      const std::ptrdiff_t first = pass.block.cell(0, y, z), end = first + whole;
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
  if (rates.has_source())
    planes<Model, true>(block, parity, rates, range, watched);
  else
    planes<Model, false>(block, parity, rates, range, watched);
}

}  // namespace

template <class T>
CollideRows<T> collide_rows(const CollisionRates<T>& rates) {
  switch (rates.model) {
    case Collision::trt:
    case Collision::bgk:
      return rows_under<TwoRelaxationTimes, T>;
    case Collision::regularised:
      return rates.keep_third != 0 || rates.keep_fourth != 0 ? rows_under<RecursiveRegularised<true>, T>
                                                             : rows_under<RecursiveRegularised<false>, T>;
  }
  __builtin_unreachable();
}
template CollideRows<float> collide_rows(const CollisionRates<float>&);
template CollideRows<double> collide_rows(const CollisionRates<double>&);

}  // namespace silt::lbm::SILT_ISA
