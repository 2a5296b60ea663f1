#include "lbm/moments.hpp"

#include "cpu/isa.hpp"
#include "lbm/moments_kernel.hpp"

namespace silt::lbm {

template <class T>
void MomentsRow::sum(const T* const (&g)[directions], int cells) {
  static const SumMoments<T> sum_moments =
      chosen(portable::moments_kernel<T>, avx2::moments_kernel<T>, avx512::moments_kernel<T>)();
  cells_ = cells;
  values_.resize(std::size_t(count) * cells);
  sum_moments(g, cells, values_.data());
}

template void MomentsRow::sum(const float* const (&)[directions], int);
template void MomentsRow::sum(const double* const (&)[directions], int);

}  // namespace silt::lbm
