// Built once an instruction set: the moments of a row of cells.
#include "lbm/moments_kernel.hpp"

namespace silt::lbm::SILT_ISA {
namespace {

template <class T>
void sum_moments(const T* const (&g)[directions], std::ptrdiff_t cells, double* moments) {
#pragma GCC ivdep
  for (std::ptrdiff_t k = 0; k < cells; ++k) {
    const Moments m = moments_of(g, k);
    moments[k] = m.density_deviation;
    for (int d = 0; d < 3; ++d) moments[k + (1 + d) * cells] = m.momentum[d];
    for (int j = 0; j < 6; ++j) moments[k + (4 + j) * cells] = m.flux[j];
  }
}

}  // namespace

template <class T>
SumMoments<T> moments_kernel() {
  return sum_moments<T>;
}
template SumMoments<float> moments_kernel<float>();
template SumMoments<double> moments_kernel<double>();

}  // namespace silt::lbm::SILT_ISA
