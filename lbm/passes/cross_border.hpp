#pragma once
// What crosses a border between levels, patch by patch (level_border.hpp): several elements of a row at a
// time, or one (SILT_SCALAR). For files built for an instruction set or a device (SILT_BUILD).
#include <cstddef>
#include <span>
#include <utility>

#include "cpu/lanes.hpp"
#include "lbm/passes/level_border_patches.hpp"

namespace silt::lbm::SILT_BUILD {

/// Cells [first, end) of rows [row, end_row) of a patch.
struct PatchPart {
  std::ptrdiff_t row, end_row, first, end;
  template <class Extent>
  SILT_DEVICE static PatchPart all_of(const Extent& size) {
    return {0, std::ptrdiff_t(size.rows), 0, std::ptrdiff_t(size.length)};
  }
  template <class Extent>
  SILT_DEVICE static PatchPart cell_of(const Extent& size, std::ptrdiff_t k) {
    const std::ptrdiff_t length = size.length, row = k / length, n = k - row * length;
    return {row, row + 1, n, n + 1};
  }
};

/// n numbers of a row; one is a plain number.
template <class T, int n>
struct Several : VectorOf<T, n> {};
template <class T>
struct Several<T, 1> {
  using type = T;
};

/// The values of a patch in an array. Those of n coarse cells of a row are read and written together; `pairs`
/// are the two fine cells side by side along x of each coarse cell.
template <class T>
struct PatchValues {
  T* first;
  std::ptrdiff_t step, pitch;
  SILT_DEVICE PatchValues(T* first, std::ptrdiff_t step, std::ptrdiff_t pitch)
      : first(first), step(step), pitch(pitch) {}
  template <class Patch>
  SILT_DEVICE PatchValues(T* const* table, const Patch& p)
      : first(table[p.array] + p.first), step(p.step), pitch(p.pitch) {}

  SILT_DEVICE T& operator()(std::ptrdiff_t row, std::ptrdiff_t n) const {
    return first[row * pitch + n * step];
  }
#if defined(SILT_SCALAR)
  template <class V>
  SILT_DEVICE V at(std::ptrdiff_t row, std::ptrdiff_t n) const {
    return (*this)(row, n);
  }
  template <class V>
  SILT_DEVICE void set(std::ptrdiff_t row, std::ptrdiff_t n, const V& v) const {
    (*this)(row, n) = v;
  }
  template <class V>
  SILT_DEVICE void pairs_at(std::ptrdiff_t row, std::ptrdiff_t n, V& low, V& high) const {
    const T* const from = &(*this)(row, n);
    low = from[0], high = from[1];
  }
  template <class V>
  SILT_DEVICE void set_pairs(std::ptrdiff_t row, std::ptrdiff_t n, const V& low, const V& high) const {
    T* const to = &(*this)(row, n);
    to[0] = low, to[1] = high;
  }
#else
  template <class V>
  static constexpr int lanes() {
    return sizeof(V) / sizeof(T);
  }
  template <class V>
  [[gnu::always_inline]] V at(std::ptrdiff_t row, std::ptrdiff_t n) const {
    if (lanes<V>() == 1 || step == 1) return load<V>(&(*this)(row, n));
    return gathered<V>(&(*this)(row, n));
  }
  template <class V>
  [[gnu::always_inline]] void set(std::ptrdiff_t row, std::ptrdiff_t n, const V& v) const {
    if (lanes<V>() == 1 || step == 1)
      store(&(*this)(row, n), v);
    else
      scatter(&(*this)(row, n), v);
  }
  template <class V>
  [[gnu::always_inline]] void pairs_at(std::ptrdiff_t row, std::ptrdiff_t n, V& low, V& high) const {
    const T* const from = &(*this)(row, n);
    if constexpr (lanes<V>() > 1) {
      if (step == 2) return unweave(load<V>(from), load<V>(from + lanes<V>()), low, high, all_lanes<V>());
    }
    low = gathered<V>(from), high = gathered<V>(from + 1);
  }
  template <class V>
  [[gnu::always_inline]] void set_pairs(std::ptrdiff_t row, std::ptrdiff_t n, const V& low,
                                        const V& high) const {
    T* const to = &(*this)(row, n);
    if constexpr (lanes<V>() > 1) {
      if (step == 2) return weave(to, low, high, all_lanes<V>());
    }
    scatter(to, low), scatter(to + 1, high);
  }

 private:
  template <class V>
  [[gnu::always_inline]] V gathered(const T* from) const {
    if constexpr (lanes<V>() == 1)
      return *from;
    else
      return each<V, lanes<V>()>([&](auto lane) { return from[lane * step]; });
  }
  template <class V>
  [[gnu::always_inline]] void scatter(T* to, const V& v) const {
    if constexpr (lanes<V>() == 1)
      *to = v;
    else
      for (int lane = 0; lane < lanes<V>(); ++lane) to[lane * step] = v[lane];
  }
  template <class V>
  using all_lanes = std::make_integer_sequence<int, lanes<V>()>;
  template <class V, int... k>
  [[gnu::always_inline]] static void unweave(const V& a, const V& b, V& even, V& odd,
                                             std::integer_sequence<int, k...>) {
    even = __builtin_shufflevector(a, b, 2 * k...);
    odd = __builtin_shufflevector(a, b, (2 * k + 1)...);
  }
  template <class V, int... k>
  [[gnu::always_inline]] static void weave(T* to, const V& even, const V& odd,
                                           std::integer_sequence<int, k...>) {
    constexpr int n = sizeof...(k);
    store(to, V(__builtin_shufflevector(even, odd, (k / 2 + k % 2 * n)...)));
    store(to + n, V(__builtin_shufflevector(even, odd, ((n + k) / 2 + k % 2 * n)...)));
  }
#endif
};

/// Calls visit(V, row, n) for the cells of a part, V being the type of as many values from n on as are
/// handled together.
template <class T, class Visit, int lanes = Lanes<T>::count>
[[gnu::always_inline]] SILT_DEVICE inline void for_row_of_part(std::ptrdiff_t row, std::ptrdiff_t n,
                                                               std::ptrdiff_t end, const Visit& visit) {
  for (; n + lanes <= end; n += lanes) visit(typename Several<T, lanes>::type(), row, n);
  if constexpr (lanes > 1) for_row_of_part<T, Visit, lanes / 2>(row, n, end, visit);
}
template <class T, class Visit>
[[gnu::always_inline]] SILT_DEVICE inline void for_part(const PatchPart& part, const Visit& visit) {
  for (std::ptrdiff_t row = part.row; row < part.end_row; ++row)
    for_row_of_part<T>(row, part.first, part.end, visit);
}

/// Returns values that a border keeps for the cells of a patch.
template <class Kept, class Extent>
SILT_DEVICE inline PatchValues<Kept> kept(Kept* first, const Extent& size) {
  return {first, 1, std::ptrdiff_t(size.length)};
}

// The steps of the exchange, for a part of an entry of a list.

/// Sets the packets of a patch: the coarse population extrapolated to a corner, minus (first step) or plus
/// (second) a quarter of the change by the last collision, i.e. a quarter of a step later or earlier.
struct Carry {
  template <class T>
  SILT_DEVICE void operator()(const BorderPatches<T>& border, const typename BorderPatches<T>::Carried& c,
                              const PatchPart& part) const {
    const PatchValues<T> value(border.coarse_left, c.value);
    const PatchValues<const T> before(border.coarse_before + c.before.first, 1, c.before.pitch);
    const std::ptrdiff_t cells = c.size.cells();
    T* const its = border.carried + c.first;
    const bool in_time = c.in_time();
    for_part<T>(part, [&]<class V>(V, std::ptrdiff_t row, std::ptrdiff_t n) {
      const V v = value.template at<V>(row, n);
      const V change = in_time ? V(before.template at<V>(row, n) - v) : V{};
      for (int s = 0; s < 2; ++s)
        kept(its + s * cells, c.size).template set<V>(row, n, in_time ? V(v + c.change[s] * change) : v);
      for (int d = 0; d < 3; ++d) {
        const PatchValues<T> above(border.coarse_left, c.above[d]), below(border.coarse_left, c.below[d]);
        kept(its + (2 + d) * cells, c.size)
            .template set<V>(row, n,
                             c.slope[d] * (above.template at<V>(row, n) - below.template at<V>(row, n)));
      }
    });
  }
};

struct Explode {
  template <class T>
  SILT_DEVICE void operator()(const BorderPatches<T>& border, const typename BorderPatches<T>::Explosion& e,
                              const PatchPart& part) const {
    const std::ptrdiff_t cells = e.size.cells();
    T* const its = border.carried + e.carried;
    const PatchValues<T> value = kept(its + border.sub_step * cells, e.size),
                         along_x = kept(its + 2 * cells, e.size), along_y = kept(its + 3 * cells, e.size),
                         along_z = kept(its + 4 * cells, e.size);
    const typename BorderPatches<T>::Packet* const packets = border.packets + e.first[border.sub_step];
    const int count = e.packets[border.sub_step];
    if (count == 0) return;
    for_part<T>(part, [&]<class V>(V, std::ptrdiff_t row, std::ptrdiff_t n) {
      const V centre = value.template at<V>(row, n), x = along_x.template at<V>(row, n),
              y = along_y.template at<V>(row, n), z = along_z.template at<V>(row, n);
      for (int k = 0; k < count; ++k) {
        const typename BorderPatches<T>::Packet& packet = packets[k];
        const auto sign = [&](int d) { return packet.corner >> d & 1 ? T(1) : T(-1); };
        const PatchValues<T> to(border.fine_arriving, packet.to);
        const V middle = centre + (sign(1) * y + sign(2) * z) + packet.addend;
        if (packet.paired)
          to.template set_pairs<V>(row, n, middle - x, middle + x);
        else
          to.template set<V>(row, n, middle + sign(0) * x);
      }
    });
  }
};

/// Adds the packets of a sub-step to the sums; changes no population.
struct AddUp {
  template <class T>
  SILT_DEVICE void operator()(const BorderPatches<T>& border, const typename BorderPatches<T>::Coalescence& c,
                              const PatchPart& part) const {
    const PatchValues<T> kept_sum = kept(border.sums + c.sum, c.size);
    const int step = border.sub_step;
    for_part<T>(part, [&]<class V>(V, std::ptrdiff_t row, std::ptrdiff_t n) {
      V sum = step == 0 ? V{} : kept_sum.template at<V>(row, n);
      for (int k = 0; k < c.sources[step]; ++k) {
        const typename BorderPatches<T>::Source& source = border.sources[c.first[step] + k];
        const PatchValues<T> from(border.fine_left, source.from);
        if (source.paired) {
          V low, high;
          from.template pairs_at<V>(row, n, low, high);
          sum = sum + low + high;
        } else {
          sum = sum + from.template at<V>(row, n);
        }
      }
      if (step == 1 && c.from_coarse > 0)
        sum = sum + T(c.from_coarse) * PatchValues<T>(border.coarse_arriving, c.to).template at<V>(row, n);
      for (int k = 0; step == 1 && k < c.taken; ++k) {
        const typename BorderPatches<T>::Taken& t = border.taken[c.first_taken + k];
        sum = sum - t.factor * PatchValues<T>(border.coarse_left, t.above).template at<V>(row, n);
        sum = sum + t.factor * PatchValues<T>(border.coarse_left, t.below).template at<V>(row, n);
      }
      kept_sum.template set<V>(row, n, sum);
    });
  }
};

/// Writes the sums of both sub-steps to the coarse cells.
struct Coalesce {
  template <class T>
  SILT_DEVICE void operator()(const BorderPatches<T>& border, const typename BorderPatches<T>::Coalescence& c,
                              const PatchPart& part) const {
    const PatchValues<T> sum = kept(border.sums + c.sum, c.size), to(border.coarse_arriving, c.to);
    for_part<T>(part, [&]<class V>(V, std::ptrdiff_t row, std::ptrdiff_t n) {
      to.template set<V>(row, n, sum.template at<V>(row, n) / T(8) + c.addend);
    });
  }
};

struct Pass {
  template <class T>
  SILT_DEVICE void operator()(const BorderPatches<T>& border, const typename BorderPatches<T>::Passing& p,
                              const PatchPart& part) const {
    const PatchValues<T> its = kept(border.sums + p.kept, p.size);
    const PatchValues<T> from(border.fine_left, p.from), to(border.fine_arriving, p.to);
    for_part<T>(part, [&]<class V>(V, std::ptrdiff_t row, std::ptrdiff_t n) {
      if (border.sub_step == 0)
        its.template set<V>(row, n, from.template at<V>(row, n));
      else
        to.template set<V>(row, n, its.template at<V>(row, n) + p.addend);
    });
  }
};

/// The half of the exchange after a coarse pass. Over()(step, border, entries) does a step for all entries of
/// a list.
template <class Over, class T>
void carry_over(const BorderPatches<T>& border, std::span<const typename BorderPatches<T>::Carried> carried) {
  Over()(Carry(), border, carried);
}
/// The half after a fine pass: everything that arrives is added up before anything is written, since a target
/// may be the source of another sum.
template <class Over, class T>
void cross_over(const BorderPatches<T>& given, const BorderLists<T>& lists,
                std::span<const typename BorderPatches<T>::Passing> passing) {
  BorderPatches<T> border = given;
  border.refer_to(lists);
  constexpr Over over;
  over(Explode(), border, lists.explosions);
  over(AddUp(), border, lists.coalescences);
  if (border.sub_step == 1) over(Coalesce(), border, lists.coalescences);
  over(Pass(), border, passing);
}

}  // namespace silt::lbm::SILT_BUILD
