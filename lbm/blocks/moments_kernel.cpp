// The moments of a row of cells, and their totals. Built once per instruction set.
#include "lbm/blocks/lane_totals.hpp"

namespace silt::lbm::SILT_BUILD {
namespace {

template <class T>
void sum_moments(const T* const (&g)[D3Q19::directions], std::ptrdiff_t cells, std::ptrdiff_t stride,
                 double* moments) {
#pragma GCC ivdep
  for (std::ptrdiff_t k = 0; k < cells; ++k) {
    const Moments m = moments_of(g, k);
    moments[k] = m.density_deviation;
    for (int d = 0; d < 3; ++d) moments[k + (1 + d) * stride] = m.momentum[d];
    for (int j = 0; j < 6; ++j) moments[k + (4 + j) * stride] = m.flux[j];
  }
}

template <class T>
CellTotals total(const T* const (&g)[D3Q19::directions], const CellRows& rows,
                 const std::array<double, 3>& force) {
  constexpr int lanes = vector_bytes / int(sizeof(T));
  const T half_force[] = {T(0.5 * force[0]), T(0.5 * force[1]), T(0.5 * force[2])};
  CellTotals all;
  if (rows.cells < lanes) {
    LaneTotals<T, 1> single;
    for (std::ptrdiff_t row = 0; row < rows.rows; ++row)
      for (int k = 0; k < rows.cells; ++k) single.template add<false>(g, row * rows.stride + k, half_force);
    single.give(std::int64_t(rows.cells) * rows.rows, all);
    return all;
  }
  LaneTotals<T, lanes> many;
  const int rest = rows.cells % lanes, most = rows.cells - rest;
  for (std::ptrdiff_t row = 0; row < rows.rows; ++row) {
    const std::ptrdiff_t begin = row * rows.stride;
    for (int k = 0; k < most; k += lanes) many.template add<false>(g, begin + k, half_force);
    if (rest > 0) many.template add<true>(g, begin + rows.cells - lanes, half_force, lanes - rest);
  }
  many.give(std::int64_t(most + (rest > 0 ? lanes : 0)) * rows.rows, all);
  return all;
}

}  // namespace

template <class T>
MomentsKernels<T> moments_kernels() {
  return {sum_moments<T>, total<T>};
}
template MomentsKernels<float> moments_kernels<float>();
template MomentsKernels<double> moments_kernels<double>();

}  // namespace silt::lbm::SILT_BUILD
