// The kernels of Table I of Goetz et al., SC10, as one writes them: two arrays, everything read from one and
// written to the other. Straightforward: the formulas, direction by direction. Optimised: pair by pair, what
// a pair shares computed once, without branches, so that a compiler can use vectors where the layout lets it.
#include "tests/bench/fluid_kernels.hpp"

namespace silt::bench::SILT_BUILD {
namespace {

using namespace lbm;

/// Slot of population i of a cell.
template <Layout layout, class T>
inline std::ptrdiff_t slot(const TwoArrays<T>& a, std::ptrdiff_t cell, int i) {
  return layout == Layout::array_of_structures ? cell * D3Q19::directions + i : cell + i * a.cells();
}

template <Layout layout, class T>
void straightforward(const TwoArrays<T>& a) {
  for (int z = 0; z < a.n; ++z)
    for (int y = 0; y < a.n; ++y)
      for (int x = 0; x < a.n; ++x) {
        T g[D3Q19::directions], rho = 0, ux = 0, uy = 0, uz = 0;
        for (int i = 0; i < D3Q19::directions; ++i) {
          g[i] = a.from[slot<layout>(a, a.cell(x - D3Q19::c[i].x, y - D3Q19::c[i].y, z - D3Q19::c[i].z), i)];
          rho += g[i], ux += T(D3Q19::c[i].x) * g[i], uy += T(D3Q19::c[i].y) * g[i],
              uz += T(D3Q19::c[i].z) * g[i];
        }
        for (int i = 0; i < D3Q19::directions; ++i) {
          const T cu = T(D3Q19::c[i].x) * ux + T(D3Q19::c[i].y) * uy + T(D3Q19::c[i].z) * uz,
                  u2 = ux * ux + uy * uy + uz * uz;
          const T equilibrium = T(D3Q19::w(i)) * (rho + T(3) * cu + T(4.5) * cu * cu - T(1.5) * u2);
          a.to[slot<layout>(a, a.cell(x, y, z), i)] = g[i] - a.omega * (g[i] - equilibrium);
        }
      }
}

template <Layout layout, class T>
void optimised_row(const TwoArrays<T>& a, int y, int z) {
  constexpr int step = layout == Layout::array_of_structures ? D3Q19::directions : 1;
  const T* from[D3Q19::directions];
  T* to[D3Q19::directions];
  for (int i = 0; i < D3Q19::directions; ++i) {
    from[i] = a.from + slot<layout>(a, a.cell(-D3Q19::c[i].x, y - D3Q19::c[i].y, z - D3Q19::c[i].z), i);
    to[i] = a.to + slot<layout>(a, a.cell(0, y, z), i);
  }
#pragma GCC ivdep
  for (std::ptrdiff_t x = 0; x < a.n * step; x += step) {
    T sum[D3Q19::pairs], difference[D3Q19::pairs];
    const T rest = from[0][x];
    T rho = rest;
#pragma GCC unroll 9
    for (int k = 0; k < D3Q19::pairs; ++k) {
      const T g = from[2 * k + 1][x], h = from[2 * k + 2][x];
      sum[k] = g + h, difference[k] = g - h;
      rho += sum[k];
    }
    const T* const d = difference;
    const T ux = d[0] + ((d[3] + d[4]) + (d[5] + d[6])), uy = d[1] + ((d[3] - d[4]) + (d[7] + d[8])),
            uz = d[2] + ((d[5] - d[6]) + (d[7] - d[8]));
    const T base = rho - T(1.5) * (ux * ux + uy * uy + uz * uz), keep = T(0.5) * (1 - a.omega);
    const T along[D3Q19::pairs] = {ux, uy, uz, ux + uy, ux - uy, ux + uz, ux - uz, uy + uz, uy - uz};
    to[0][x] = rest - a.omega * (rest - T(D3Q19::w(0)) * base);
#pragma GCC unroll 9
    for (int k = 0; k < D3Q19::pairs; ++k) {
      const T weight = a.omega * T(D3Q19::w(2 * k + 1)), cu = along[k];
      const T even = keep * sum[k] + weight * (base + T(4.5) * cu * cu),
              odd = keep * d[k] + T(3) * weight * cu;
      to[2 * k + 1][x] = even + odd, to[2 * k + 2][x] = even - odd;
    }
  }
}

template <Layout layout, class T>
void in_layout(const TwoArrays<T>& a, Effort effort) {
  if (effort == Effort::straightforward) return straightforward<layout>(a);
  for (int z = 0; z < a.n; ++z)
    for (int y = 0; y < a.n; ++y) optimised_row<layout>(a, y, z);
}

template <class T>
void in_any_layout(const TwoArrays<T>& a, Layout layout, Effort effort) {
  layout == Layout::array_of_structures ? in_layout<Layout::array_of_structures>(a, effort)
                                        : in_layout<Layout::structure_of_arrays>(a, effort);
}

}  // namespace

template <class T>
PullAndRelax<T> pull_and_relax() {
  return in_any_layout<T>;
}
template PullAndRelax<float> pull_and_relax();
template PullAndRelax<double> pull_and_relax();

}  // namespace silt::bench::SILT_BUILD
