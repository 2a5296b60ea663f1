#pragma once
// The kernels of cut links as each of their builds offers them (cut_links_kernel.cpp,
// link_stiffness_kernel.cpp).
#include "cpu/isa.hpp"
#include "lbm/cut_links.hpp"

namespace silt::lbm {

/// What cut_links.hpp declares, under the same names.
template <class T>
struct LinkKernels {
  void (*apply)(const GroupInBlock<T>&, const SurfaceMotion&, ForceForm, LinkSums&);
  void (*correct)(const GroupInBlock<T>&, const SurfaceMotion& increment, LinkSums&);
};
/// Adds the stiffness of all links of a surface.
template <class T>
using AddStiffness = void (*)(const CutLinks<T>&, int exponent, StiffnessSums&);

SILT_BUILDS(template <class T> LinkKernels<T> link_kernels();
            template <class T> AddStiffness<T> stiffness_kernel();)

}  // namespace silt::lbm
