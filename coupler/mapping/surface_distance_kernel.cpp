// Built once per instruction set.
#include "coupler/mapping/surface_distance.hpp"

namespace silt::coupler::SILT_BUILD {

namespace {

/// Sets the distance of each link, in links, to the first part of the surface that it enters.
template <class Real, class T>
void set_distances(const PlacedLinks& links, const lbm::SurfaceFrame& frame, const SurfaceView<Real>& surface,
                   Real past, T* q) {
  using L = Lanes<Real>;
  using Places = lbm::SILT_BUILD::Places<Real>;
  using Stored = typename VectorOf<T, L::count>::type;
  const lbm::SILT_BUILD::PlaceOrigin<Real> origin(links.corner, frame);
  const auto set = [&](auto&& distance) {
    for (int l = 0; l < links.padded; l += L::count) {
      const Stored found = __builtin_convertvector(distance(Places(links.place + l, origin)), Stored);
      __builtin_memcpy(q + l, &found, sizeof found);
    }
  };
  if (surface.count == 1)
    with_kind(surface.parts[0].kind, [&](auto kind) {
      set([&](const Places& at) { return distance_to_part<kind()>(at, surface, past); });
    });
  else
    set([&](const Places& at) { return distance_to_any(at, surface, past); });
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
