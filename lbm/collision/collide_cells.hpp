#pragma once
// Collides cells in place: a vector of cells at a time, or one cell (SILT_SCALAR).
//
// The populations that arrive at a cell along pair i, opposite i are in slots A and B; the one that leaves
// along i goes to B, the one against it to A. Parity only decides where A and B are: one pass serves all
// steps.
#include <cmath>

#include "cpu/lanes.hpp"
#if !defined(SILT_SCALAR)
#include "cpu/prefetch.hpp"
#endif
#include "lbm/blocks/block.hpp"
#include "lbm/blocks/excess.hpp"
#include "lbm/collision/recursive_regularised_kernel.hpp"
#include "lbm/collision/rows.hpp"
#include "lbm/collision/two_relaxation_times_kernel.hpp"

namespace silt::lbm::SILT_BUILD {

template <class T>
struct Slots {  // slots A, B of each pair and the rest's, of cell 0: add Block::cell for others
  T* a[D3Q19::pairs];
  T* b[D3Q19::pairs];
  T* rest;
  Slots(Block<T>& block, Parity parity) : rest(block.data() + block.slot(0)) {
    for (int k = 0; k < D3Q19::pairs; ++k) {
      a[k] = block.data() + block.arriving(2 * k + 1, parity);
      b[k] = block.data() + block.arriving(2 * k + 2, parity);
    }
  }
  SILT_DEVICE T* arriving(int i) const { return i == 0 ? rest : i % 2 ? a[i / 2] : b[i / 2 - 1]; }
};

/// Calls found(offset, speed) for cells that are too fast or whose speed is not a number, at the cost of a
/// comparison and a branch.
template <class T, class Found>
struct Watch {
  T limit, scale;  // of the squares from the model; the squares over squared speeds
  Found found;
  template <class V, class Keep>
  [[gnu::always_inline]] SILT_DEVICE void see(const V& square, std::ptrdiff_t x, const Keep& keep) const {
    const V seen = keep(square, V{});
    if (any_lane(!(seen <= V{} + limit))) [[unlikely]]
      note(seen, x);
  }
  template <class V>
  [[gnu::noinline, gnu::cold]] SILT_DEVICE void note(const V seen, std::ptrdiff_t x) const {
    for (int i = 0; i < Lanes<T>::count; ++i)
      if (const T square = lane_of(seen, i); !(square <= limit))
        found(x + i, std::sqrt(double(square) / double(scale)));
  }
};
struct Unseen {
  template <class V, class Keep>
  [[gnu::always_inline]] SILT_DEVICE void see(const V&, std::ptrdiff_t, const Keep&) const {}
};

template <class T>
using QuantaLanes = typename VectorOf<ExcessQuanta<T>, Lanes<T>::count>::type;

/// Subtracts the excess of a vector of cells from their populations.
template <class T>
[[gnu::always_inline]] SILT_DEVICE inline void take_excess_of_cells(const Slots<T>& slots, std::ptrdiff_t x,
                                                                    ExcessQuanta<T>* excess, T stress_share) {
  using V = typename Lanes<T>::Real;
  const auto quanta = load<QuantaLanes<T>>(excess + x);
  if (!any_lane(quanta != QuantaLanes<T>{})) return;
  const auto g = [&](int i) { return load<V>(slots.arriving(i) + x); };
  const auto given = given_up<T>(converted<V>(quanta), stress_share, g);
  for (int i = 0; i < D3Q19::directions; ++i) store(slots.arriving(i) + x, V(given.left(i, g(i))));
  store(excess + x, QuantaLanes<T>{});
}

/// Prefetches populations: hardware prefetchers follow too few streams for nineteen arrays.
struct Prefetch {
#if defined(SILT_SCALAR)
  template <class T>
  SILT_DEVICE void operator()(const T*) const {}
#else
  static constexpr int bytes = 512;  // best of 256 to 1536 for large blocks, 640 for 80^3
  template <class T>
  void operator()(const T* p) const {
    prefetch_to_write(p + bytes / sizeof(T));
  }
#endif
};

/// The excess of the cells of a block (excess.hpp), which they give up when they collide.
template <class T>
struct HeldExcess {
  ExcessQuanta<T>* quanta;  // of cell 0
  T stress_share;
  explicit HeldExcess(Block<T>& block) : quanta(block.excess()), stress_share(block.stress_share()) {}
  /// Sets the excess of a vector of cells to zero; returns the amounts that they give up with it.
  template <class Keep, class V = typename Lanes<T>::Real>
  [[gnu::always_inline]] SILT_DEVICE GivenUp<V> take(const Slots<T>& slots, std::ptrdiff_t x,
                                                     const Keep& keep) const {
    constexpr QuantaLanes<T> none{};
    const auto held = load<QuantaLanes<T>>(quanta + x);
    if constexpr (Lanes<T>::count == 1)
      if (held == none) return {};  // writes nothing, as most cells
    store(quanta + x, keep(none, held));
    return given_up<T>(converted<V>(keep(held, none)), stress_share,
                       [&](int i) { return load<V>(slots.arriving(i) + x); });
  }
};
/// Cells without an excess give up nothing.
struct NoExcess {
  struct Nothing {
    template <class V>
    SILT_DEVICE const V& left(int, const V& g) const {
      return g;
    }
  };
  template <class T, class Keep>
  SILT_DEVICE Nothing take(const Slots<T>&, std::ptrdiff_t, const Keep&) const {
    return {};
  }
};

/// Collides the vector of cells from x on, at the rates of carry_heat.hpp. Slots of lanes outside the row
/// keep their values.
template <class Model, bool source, class V, class T, class Rates, class Keep, class Watch, class Excess>
[[gnu::always_inline]] SILT_DEVICE inline void collide(const Slots<T>& slots, std::ptrdiff_t x,
                                                       const Rates& rates, const Keep& keep,
                                                       const Watch& watch, const Excess& excess) {
  constexpr Prefetch prefetch;
  const auto given = excess.take(slots, x, keep);
  V sum[D3Q19::pairs + 1], difference[D3Q19::pairs];
  const auto arriving = [&](int i, const T* from) __attribute__((always_inline)) {
    prefetch(from + x);
    return V(given.left(i, load<V>(from + x)));
  };
  for (int k = 0; k < D3Q19::pairs; ++k) {
    const V a = arriving(2 * k + 1, slots.a[k]), b = arriving(2 * k + 2, slots.b[k]);
    sum[k] = a + b;
    difference[k] = a - b;
  }
  sum[D3Q19::pairs] = arriving(0, slots.rest);

  const auto set_rest = [&](const V& left) __attribute__((always_inline)) {
    store(slots.rest + x, keep(left, sum[D3Q19::pairs]));
  };
  const auto set_pair = [&](int k, const V& p, const V& q) __attribute__((always_inline)) {
    store(slots.a[k] + x, keep(V(p - q), load<V>(slots.a[k] + x)));
    store(slots.b[k] + x, keep(V(p + q), load<V>(slots.b[k] + x)));
  };
  const auto see = [&](const V& square) __attribute__((always_inline)) {
    watch.see(square, x, keep);
  };
  Model::template collide<source>(sum, difference, rates.at(x, difference, keep), set_rest, set_pair, see);
}

/// Calls f(model) with the collision model of the rates.
template <class T, class F>
auto with_model(const CollisionRates<T>& rates, F&& f) {
  switch (rates.model) {
    case Collision::trt:
    case Collision::bgk:
      return f(TwoRelaxationTimes{});
    case Collision::regularised:
      return rates.keep_third != 0 || rates.keep_fourth != 0 ? f(RecursiveRegularised<true>{})
                                                             : f(RecursiveRegularised<false>{});
  }
  __builtin_unreachable();
}

}  // namespace silt::lbm::SILT_BUILD
