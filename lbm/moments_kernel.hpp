#pragma once
// The kernels of rows of cells as each of their builds offers them (moments_kernel.cpp).
#include "cpu/isa.hpp"
#include "lbm/moments.hpp"

namespace silt::lbm {

template <class T>
struct MomentsKernels {
  /// Writes moment j of the k-th cell to moments[j * stride + k], in the order of MomentArrays.
  void (*sum)(const T* const (&g)[directions], std::ptrdiff_t cells, std::ptrdiff_t stride, double* moments);
  CellTotals (*total)(const T* const (&g)[directions], const CellRows&, const std::array<double, 3>& force);
};

SILT_BUILDS(template <class T> MomentsKernels<T> moments_kernels();)

}  // namespace silt::lbm
