// Built once per instruction set.
#include "coupler/mapping/surface_distance.hpp"

namespace silt::coupler::SILT_BUILD {

namespace {

/// Sets the distance of each link, in links, to the first part of the surface that it enters.
template <class Real, class T>
[[gnu::flatten]] void set_distances(const PlacedLinks& links, const lbm::SurfaceFrame& frame,
                                    const SurfaceView<Real>& surface, Real past, T* q) {
  using L = Lanes<Real>;
  using Stored = typename VectorOf<T, L::count>::type;
  const lbm::SILT_BUILD::PlaceOrigin<Real> origin(links.corner, frame);
  const auto set = [&](auto&& distance) {
    for (int l = 0; l < links.padded; l += L::count)
      store(q + l, converted<Stored>(distance(lbm::SILT_BUILD::Places<Real>(links.place + l, origin))));
  };
  if (surface.count > 1) return set([&](const auto& at) { return distance_to_any(at, surface, past); });
  with_kind(surface.parts[0].kind, [&](auto kind) {  // once, not in each vector
    set([&](const auto& at) { return distance_to_part<kind()>(at, surface, past); });
  });
}

template <class T>
std::uint32_t keep(std::uint32_t* place, std::uint32_t n, lbm::Int3 corner, const lbm::SurfaceFrame& frame,
                   const SurfaceView<T>& surface, T* begin, T* end) {
  const lbm::SILT_BUILD::PlaceOrigin<T> origin(corner, frame);
  std::uint32_t kept = 0;
  for (std::uint32_t l = 0; l < n; l += Lanes<T>::count) {
    const Crossings<T> found = crossings_of(place + l, origin, surface);
    for (std::uint32_t k = 0; any_lane(found.cross) && k < Lanes<T>::count && l + k < n; ++k)
      if (found.cross[k])
        place[kept] = place[l + k], begin[kept] = found.begin[k], end[kept++] = found.end[k];
  }
  return kept;
}

}  // namespace

template <class T>
KeepCrossings<T> keep_crossings() {
  return keep<T>;
}
template KeepCrossings<float> keep_crossings();
template KeepCrossings<double> keep_crossings();

template <class Real, class T>
SurfaceDistances<Real, T> surface_distances() {
  return set_distances<Real, T>;
}
template SurfaceDistances<float, float> surface_distances();
template SurfaceDistances<double, float> surface_distances();
template SurfaceDistances<double, double> surface_distances();

}  // namespace silt::coupler::SILT_BUILD
