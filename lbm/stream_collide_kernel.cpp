// Built once an instruction set (SILT_ISA names the namespace). Bytes a cell and step: 19 reads, 19 writes.
//
// The populations of a pair i, opposite i that arrive at a cell lie in two slots A and B; what leaves along i
// goes to B and what leaves against it to A. Where A and B are is all that the parity decides, so one loop
// serves the even and the odd step.
#include "lbm/kernels.hpp"

namespace silt::lbm::SILT_ISA {
namespace {

#if defined(SILT_ISA_avx512)
inline constexpr int vector_bytes = 64;
#elif defined(SILT_ISA_avx2)
inline constexpr int vector_bytes = 32;
#else
inline constexpr int vector_bytes = 16;
#endif
inline constexpr int prefetch_bytes = 1024;  // ahead of use; measured best between 0.5 and 2 KiB

template <class T>
struct VectorOf {
  typedef T type __attribute__((vector_size(vector_bytes)));
};

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
struct Rows {  // one row of cells: its slots A and B of each pair, and the resting populations
  T* a[pairs];
  T* b[pairs];
  T* rest;
};

template <int k, class V>
inline V along(const V& x, const V& y, const V& z) {  // c_i . (x, y, z) of pair k, i = 2k + 1
  constexpr Int3 v = c[2 * k + 1];
  if constexpr (v.x == 1 && v.y == 0 && v.z == 0) return x;
  if constexpr (v.x == 0 && v.y == 1 && v.z == 0) return y;
  if constexpr (v.x == 0 && v.y == 0 && v.z == 1) return z;
  if constexpr (v.x == 1 && v.y == 1) return x + y;
  if constexpr (v.x == 1 && v.y == -1) return x - y;
  if constexpr (v.x == 1 && v.z == 1) return x + z;
  if constexpr (v.x == 1 && v.z == -1) return x - z;
  if constexpr (v.y == 1 && v.z == 1) return y + z;
  if constexpr (v.y == 1 && v.z == -1) return y - z;
}

template <int k, bool source, class V, class T>
inline void relax_pair(V& a, V& b, const V& base, const V& ux, const V& uy, const V& uz, const V& uf,
                       const CollisionRates<T>& r) {
  constexpr T weight = T(w(2 * k + 1));
  const V cu = along<k>(ux, uy, uz);
  V even = r.omega_even * (T(0.5) * (a + b) - weight * (base + T(4.5) * cu * cu));
  V odd = r.omega_odd * (T(0.5) * (a - b) - T(3) * weight * cu);
  if constexpr (source) {
    const T cf = along<k>(r.fx, r.fy, r.fz);
    even -= r.force_even * weight * (T(9) * cf * cu - T(3) * uf) + weight * r.anchor;
    odd -= r.force_odd * (T(3) * weight * cf);
  }
  const V out_i = a - even - odd, out_opposite = b - even + odd;
  a = out_opposite, b = out_i;
}

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

/// The cells from x on, as many as a vector has. Slots of lanes that are no cells keep what they hold: no
/// other lane of the vector has them.
template <bool source, class V, class T, class Keep>
inline void collide(const Rows<T>& rows, std::ptrdiff_t x, const CollisionRates<T>& r, const Keep& keep) {
  V a[pairs], b[pairs];
  V rest = load<V>(rows.rest + x);
  for (int k = 0; k < pairs; ++k) a[k] = load<V>(rows.a[k] + x), b[k] = load<V>(rows.b[k] + x);

  V rho = rest;
  for (int k = 0; k < pairs; ++k) rho += a[k] + b[k];
  V d[pairs];
  for (int k = 0; k < pairs; ++k) d[k] = a[k] - b[k];
  V ux = d[0] + ((d[3] + d[4]) + (d[5] + d[6]));
  V uy = d[1] + ((d[3] - d[4]) + (d[7] + d[8]));
  V uz = d[2] + ((d[5] - d[6]) + (d[7] - d[8]));
  V uf = rest - rest;
  if constexpr (source) {
    ux += T(0.5) * r.fx, uy += T(0.5) * r.fy, uz += T(0.5) * r.fz;
    uf = ux * r.fx + uy * r.fy + uz * r.fz;
  }
  const V base = rho - T(1.5) * (ux * ux + uy * uy + uz * uz);

  relax_pair<0, source>(a[0], b[0], base, ux, uy, uz, uf, r);
  relax_pair<1, source>(a[1], b[1], base, ux, uy, uz, uf, r);
  relax_pair<2, source>(a[2], b[2], base, ux, uy, uz, uf, r);
  relax_pair<3, source>(a[3], b[3], base, ux, uy, uz, uf, r);
  relax_pair<4, source>(a[4], b[4], base, ux, uy, uz, uf, r);
  relax_pair<5, source>(a[5], b[5], base, ux, uy, uz, uf, r);
  relax_pair<6, source>(a[6], b[6], base, ux, uy, uz, uf, r);
  relax_pair<7, source>(a[7], b[7], base, ux, uy, uz, uf, r);
  relax_pair<8, source>(a[8], b[8], base, ux, uy, uz, uf, r);
  V change = r.omega_even * (rest - T(w(0)) * base);
  if constexpr (source) change -= r.force_even * T(w(0)) * (T(-3) * uf) + T(w(0)) * r.anchor;

  store(rows.rest + x, keep(V(rest - change), rest));
  for (int k = 0; k < pairs; ++k) {
    store(rows.a[k] + x, keep(a[k], load<V>(rows.a[k] + x)));
    store(rows.b[k] + x, keep(b[k], load<V>(rows.b[k] + x)));
  }
}

template <class T>
inline void close_row(T* first, const std::vector<RowEnd<T>>& ends) {
  for (const RowEnd<T>& end : ends) first[end.to] = end.wall ? first[end.from] + end.addend : first[end.from];
}

template <bool source, class T>
void row_range(Block<T>& block, Parity parity, const CollisionRates<T>& rates, RowRange range) {
  using V = typename VectorOf<T>::type;
  constexpr int width = vector_bytes / sizeof(T), ahead = prefetch_bytes / sizeof(T);
  const std::ptrdiff_t nx = block.size().x;
  for (int z = range.z0; z < range.z1; ++z)
    for (int y = range.y0; y < range.y1; ++y) {
      Rows<T> rows;
      T* const first = block.data() + block.cell(0, y, z);
      rows.rest = first + block.slot(0);
      for (int k = 0; k < pairs; ++k) {
        rows.a[k] = first + block.arriving(2 * k + 1, parity);
        rows.b[k] = first + block.arriving(2 * k + 2, parity);
      }
      std::ptrdiff_t x = 0;
      for (; x + width <= nx; x += width) {
        __builtin_prefetch(rows.rest + x + ahead, 1);
        for (int k = 0; k < pairs; ++k) {
          __builtin_prefetch(rows.a[k] + x + ahead, 1);
          __builtin_prefetch(rows.b[k] + x + ahead, 1);
        }
        collide<source, V>(rows, x, rates, AllLanes{});
      }
      if (x < nx) collide<source, V>(rows, x, rates, Lanes<V, T>(nx - x));
      close_row(first, block.row_ends(parity));
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
