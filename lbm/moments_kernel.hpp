#pragma once
// The kernel of rows of moments as each of its builds offers it (moments_kernel.cpp).
#include "lbm/moments.hpp"

namespace silt::lbm {

/// Writes moment j of the k-th cell to moments[j * cells + k], in the order of MomentsRow.
template <class T>
using SumMoments = void (*)(const T* const (&g)[directions], std::ptrdiff_t cells, double* moments);

namespace portable {
template <class T>
SumMoments<T> moments_kernel();
}
namespace avx2 {
template <class T>
SumMoments<T> moments_kernel();
}
namespace avx512 {
template <class T>
SumMoments<T> moments_kernel();
}

}  // namespace silt::lbm
