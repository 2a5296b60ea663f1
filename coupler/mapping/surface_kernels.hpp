#pragma once
// The kernel of wall distances, built once an instruction set.
#include "coupler/mapping/surface_primitives.hpp"
#include "lbm/cut_links.hpp"

namespace silt::coupler {

/// Sets the wall distances of links, whole vectors of them.
template <class Real, class T>
using SurfaceDistances = void (*)(const std::uint32_t* place, int padded, const lbm::SurfaceFrame&,
                                  lbm::Int3 corner, const SurfaceView<Real>&, T* q);
namespace portable {
template <class Real, class T>
SurfaceDistances<Real, T> surface_distances();
}
namespace avx2 {
template <class Real, class T>
SurfaceDistances<Real, T> surface_distances();
}
namespace avx512 {
template <class Real, class T>
SurfaceDistances<Real, T> surface_distances();
}

}  // namespace silt::coupler
