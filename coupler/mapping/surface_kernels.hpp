#pragma once
// The kernel of wall distances, built once an instruction set.
#include "coupler/mapping/surface_primitives.hpp"
#include "lbm/cut_links.hpp"
#include "lbm/isa.hpp"

namespace silt::coupler {

using lbm::chosen_isa;
using lbm::Isa;

}  // namespace silt::coupler

#define SILT_SURFACE_KERNELS(isa)                                                                            \
  namespace silt::coupler::isa {                                                                             \
  template <class Real, class T>                                                                             \
  void surface_distances(const std::uint32_t* place, int padded, const lbm::SurfaceFrame&, lbm::Int3 corner, \
                         const SurfaceView<Real>&, T* q);                                                    \
  }

SILT_SURFACE_KERNELS(portable)
SILT_SURFACE_KERNELS(avx2)
SILT_SURFACE_KERNELS(avx512)
