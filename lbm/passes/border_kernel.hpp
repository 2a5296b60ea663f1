#pragma once
// The pass over a border between levels on the CPU, built once per instruction set (border_kernel.cpp).
#include <span>

#include "cpu/isa.hpp"
#include "lbm/passes/level_border_patches.hpp"

namespace silt::lbm {

template <class T>
using CrossBorder = void (*)(const BorderPatches<T>&, const BorderLists<T>&,
                             std::span<const typename BorderPatches<T>::Passing>);
SILT_BUILDS(template <class T> CrossBorder<T> border_kernel();)

}  // namespace silt::lbm
