// Built once per instruction set.
#include "coupler/mapping/surface_distance.hpp"

namespace silt::coupler::SILT_BUILD {

namespace {

/// Sets the distance of each link, in links, to the first part of the surface that it enters.
template <class Real, class T>
void set_distances(const PlacedLinks& links, const lbm::SurfaceFrame& frame, const SurfaceView<Real>& surface,
                   Real past, T* q) {
  using L = Lanes<Real>;
  using Stored = typename VectorOf<T, L::count>::type;
  const lbm::SILT_BUILD::PlaceOrigin<Real> origin(links.corner, frame);
  for (int l = 0; l < links.padded; l += L::count)
    store(q + l, converted<Stored>(distance_of(links.place + l, origin, surface, past)));
}

}  // namespace

template <class Real, class T>
SurfaceDistances<Real, T> surface_distances() {
  return set_distances<Real, T>;
}
template SurfaceDistances<float, float> surface_distances();
template SurfaceDistances<double, float> surface_distances();
template SurfaceDistances<double, double> surface_distances();

}  // namespace silt::coupler::SILT_BUILD
