#include "lbm/moments.hpp"

#include "cpu/isa.hpp"
#include "lbm/moments_kernel.hpp"

namespace silt::lbm {

namespace {

template <class T>
const MomentsKernels<T>& kernels() {
  static const MomentsKernels<T> all = SILT_CHOSEN(moments_kernels<T>)();
  return all;
}

}  // namespace

template <class T>
void MomentArrays::sum(const T* const (&g)[directions], std::int64_t first, int cells) {
  kernels<T>().sum(g, cells, cells_, values_.data() + first);
}

template <class T>
CellTotals cell_totals(const T* const (&g)[directions], const CellRows& rows,
                       const std::array<double, 3>& force) {
  return kernels<T>().total(g, rows, force);
}

template void MomentArrays::sum(const float* const (&)[directions], std::int64_t, int);
template void MomentArrays::sum(const double* const (&)[directions], std::int64_t, int);
template CellTotals cell_totals(const float* const (&)[directions], const CellRows&,
                                const std::array<double, 3>&);
template CellTotals cell_totals(const double* const (&)[directions], const CellRows&,
                                const std::array<double, 3>&);

}  // namespace silt::lbm
