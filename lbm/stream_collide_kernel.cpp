// Built once an instruction set (SILT_ISA names the namespace). Bytes a cell and step: 19 reads, 19 writes.
//
// The populations of a pair i, opposite i that arrive at a cell lie in two slots A and B; what leaves along i
// goes to B and what leaves against it to A. Where A and B are is all that the parity decides, so one loop
// serves the even and the odd step.
#include "lbm/isa_vector.hpp"
#include "lbm/kernels.hpp"

namespace silt::lbm::SILT_ISA {
namespace {

inline constexpr int prefetch_bytes = 512;  // best of 256 to 1536 for large blocks, 640 for 80^3

template <class V, class T>
inline V load(const T* p) {
  V v;
  __builtin_memcpy(&v, p, sizeof v);
  return v;
}
template <class V, class T>
inline void store(T* p, const V& v) {
  __builtin_memcpy(p, &v, sizeof v);
}

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

/// Which lanes of a vector are cells: the first `cells`.
template <class V, class T>
struct Lanes {
  static constexpr int count = sizeof(V) / sizeof(T);
  decltype(V{} < V{}) inside;
  explicit Lanes(std::ptrdiff_t cells) {
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

/// Ahead of use, so that memory answers in time: the hardware's own streams are too few for nineteen arrays.
struct Prefetch {
  template <class T>
  void operator()(const T* p) const {
    __builtin_prefetch(p + prefetch_bytes / sizeof(T), 1);
  }
};

/// The cells from x on, as many as a vector has. Slots of lanes that are no cells keep what they hold: no
/// other lane of the vector has them. collision.hpp says what is computed.
template <bool source, class V, class T, class Keep>
[[gnu::always_inline]] inline void collide(const Slots<T>& slots, std::ptrdiff_t x,
                                           const CollisionRates<T>& r, const Keep& keep) {
  constexpr Prefetch prefetch;
  V sum[pairs], difference[pairs];
  for (int k = 0; k < pairs; ++k) {
    const V a = load<V>(slots.a[k] + x), b = load<V>(slots.b[k] + x);
    prefetch(slots.a[k] + x), prefetch(slots.b[k] + x);
    sum[k] = a + b, difference[k] = a - b;
  }
  const V rest = load<V>(slots.rest + x);
  prefetch(slots.rest + x);

  const V rho =
      ((sum[0] + sum[1]) + (sum[2] + sum[3])) + ((sum[4] + sum[5]) + (sum[6] + sum[7])) + (sum[8] + rest);
  const V* const d = difference;
  V ux = d[0] + ((d[3] + d[4]) + (d[5] + d[6]));
  V uy = d[1] + ((d[3] - d[4]) + (d[7] + d[8]));
  V uz = d[2] + ((d[5] - d[6]) + (d[7] - d[8]));
  if constexpr (source) ux += r.half_force[0], uy += r.half_force[1], uz += r.half_force[2];

  V kx = r.square * ux, ky = r.square * uy, kz = r.square * uz;
  if constexpr (source) kx += r.even_force[0], ky += r.even_force[1], kz += r.even_force[2];
  const V xx = kx * ux, yy = ky * uy, zz = kz * uz;
  V isotropic = r.density * rho - (xx + yy + zz);
  if constexpr (source) isotropic += T(1. / 36) * r.mass_correction;
  V qx = r.momentum * ux, qy = r.momentum * uy, qz = r.momentum * uz;
  if constexpr (source) qx += r.odd_force[0], qy += r.odd_force[1], qz += r.odd_force[2];

  store(slots.rest + x, keep(V(r.keep_even_twice * rest + T(12) * isotropic), rest));
  const auto relax = [&](int k, const V& even, const V& odd) __attribute__((always_inline)) {
    const V p = r.keep_even * sum[k] + even, q = r.keep_odd * difference[k] + odd;
    store(slots.a[k] + x, keep(V(p - q), load<V>(slots.a[k] + x)));
    store(slots.b[k] + x, keep(V(p + q), load<V>(slots.b[k] + x)));
  };
  const V x3 = isotropic + T(3) * xx, y3 = T(3) * yy, z3 = T(3) * zz;
  relax(0, x3 + x3, qx + qx);
  const V y1 = isotropic + y3, z1 = isotropic + z3;
  relax(1, y1 + y1, qy + qy);
  relax(2, z1 + z1, qz + qz);
  V xy, xz, yz;
  if constexpr (source) {
    xy = T(3) * (kx * uy + ky * ux), xz = T(3) * (kx * uz + kz * ux), yz = T(3) * (ky * uz + kz * uy);
  } else {
    const V kx6 = T(6) * kx;
    xy = kx6 * uy, xz = kx6 * uz, yz = T(6) * ky * uz;
  }
  const V sxy = x3 + y3, sxz = x3 + z3, syz = y1 + z3;
  relax(3, sxy + xy, qx + qy);
  relax(4, sxy - xy, qx - qy);
  relax(5, sxz + xz, qx + qz);
  relax(6, sxz - xz, qx - qz);
  relax(7, syz + yz, qy + qz);
  relax(8, syz - yz, qy - qz);
}

template <class T>
inline void close_row(T* first, const std::vector<RowEnd<T>>& ends) {
  for (const RowEnd<T>& end : ends) first[end.to] = end.wall ? first[end.from] + end.addend : first[end.from];
}

template <bool source, class T>
void row_range(Block<T>& block, Parity parity, const CollisionRates<T> rates, RowRange range) {
  using V = typename VectorOf<T>::type;
  constexpr int width = vector_bytes / sizeof(T);
  const int nx = block.size().x, whole = nx / width * width;
  const Slots<T> slots(block, parity);
  const Lanes<V, T> rest_of_row(nx - whole);
  for (int z = range.z0; z < range.z1; ++z)
    for (int y = range.y0; y < range.y1; ++y) {
      const std::ptrdiff_t first = block.cell(0, y, z), end = first + whole;
      for (std::ptrdiff_t x = first; x < end; x += width) collide<source, V>(slots, x, rates, AllLanes{});
      if (whole < nx) collide<source, V>(slots, end, rates, rest_of_row);
      close_row(block.data() + first, block.row_ends(parity));
    }
}

}  // namespace

template <class T>
void stream_collide_rows(Block<T>& block, Parity parity, const CollisionRates<T>& rates, RowRange range) {
  rates.source ? row_range<true>(block, parity, rates, range) : row_range<false>(block, parity, rates, range);
}
template void stream_collide_rows(Block<float>&, Parity, const CollisionRates<float>&, RowRange);
template void stream_collide_rows(Block<double>&, Parity, const CollisionRates<double>&, RowRange);

}  // namespace silt::lbm::SILT_ISA
