#pragma once
// The passes over a border between levels on the CPU, built once per instruction set (border_kernel.cpp).
#include <span>

#include "cpu/isa.hpp"
#include "lbm/passes/level_border_patches.hpp"

namespace silt::lbm {

template <class T>
struct BorderKernels {
  void (*carry_packets)(const BorderPatches<T>&, std::span<const typename BorderPatches<T>::Carried>);
  void (*cross_border)(const BorderPatches<T>&, const BorderLists<T>&,
                       std::span<const typename BorderPatches<T>::Passing>);
};
SILT_BUILDS(template <class T> BorderKernels<T> border_kernels();)

}  // namespace silt::lbm
