#pragma once
// The kernel of wall distances, built once an instruction set.
#include "coupler/mapping/surface_primitives.hpp"
#include "cpu/isa.hpp"
#include "lbm/cut_links.hpp"

namespace silt::coupler {

/// Sets the wall distances of links, whole vectors of them, with the lip of bodies of one part
/// (edge_lip.hpp). They are found up to `past` before and after the link, in units of it, of a surface that
/// has moved past one of the link's ends; 1 + past for a line that does not meet it there.
template <class Real, class T>
using SurfaceDistances = void (*)(const std::uint32_t* place, int padded, const lbm::SurfaceFrame&,
                                  lbm::Int3 corner, const SurfaceView<Real>&, Real past, T* q);
SILT_BUILDS(template <class Real, class T> SurfaceDistances<Real, T> surface_distances();)
/// The build that runs here.
template <class Real, class T>
SurfaceDistances<Real, T> distance_kernel() {
  return SILT_CHOSEN(surface_distances<Real, T>)();
}

}  // namespace silt::coupler
