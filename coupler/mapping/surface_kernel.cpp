// Built once an instruction set.
#include "coupler/mapping/edge_lip.hpp"
#include "lbm/link_places.hpp"

namespace silt::coupler::SILT_ISA {

namespace {

/// Where lines enter, within [-past, 1 + past]; 1 + past where they do not. A line that has a convex part
/// behind it, or leaves it just now, has the middle of its way through it behind.
template <class T>
auto first_inside(const IntervalLanes<T>& i, T past) {
  using V = typename IntervalLanes<T>::V;
  const V end = V{} + (T(1) + past), t = (i.enter <= i.leave) & (i.enter + i.leave > T(0)) ? i.enter : end;
  return V(t < -past ? V{} - past : t > end ? end : t);
}

/// Where lines from the hole of a hollow leave it, within [0, 1].
template <class T>
auto last_inside(const IntervalLanes<T>& i) {
  using V = typename IntervalLanes<T>::V;
  return V(i.leave > T(0) ? i.leave > T(1) ? V{} + T(1) : i.leave : V{});
}

/// Of a vector of links, to one part.
template <PartKind kind, class T>
auto distance_to(const LineLanes<T, kind>& lines, const SurfacePart<T>& part, const Plane<T>* planes,
                 T past) {
  const auto inside = lines.inside(part, planes);
  if constexpr (is_hollow(kind))
    return last_inside(inside);
  else
    return first_inside(inside, past);
}

/// To the nearest part. Each lane by itself leaves out what is beyond it: what the others do cannot matter.
template <class T>
auto distance_to_any(const lbm::SILT_ISA::Places<T>& at, const SurfaceView<T>& surface, T past) {
  auto nearest = typename IntervalLanes<T>::V{} + (T(1) + past);
  for (const SurfacePart<T>* part = surface.parts; part < surface.parts + surface.count; ++part)
    with_kind(part->kind, [&](auto kind) {
      const LineLanes<T, kind()> lines(*part, at.r, at.c);
      const auto beyond = lines.beyond(*part, past);
      if (Lanes<T>::all(beyond)) return;
      const auto found = distance_to(lines, *part, surface.planes, past);
      nearest = beyond | (nearest < found) ? nearest : found;
    });
  return nearest;
}

/// Sets the distance of each link, in units of it, to the first part of the surface that it enters.
template <class Real, class T>
void set_distances(const PlacedLinks& links, const lbm::SurfaceFrame& frame, const SurfaceView<Real>& surface,
                   Real past, T* q) {
  using L = Lanes<Real>;
  using Places = lbm::SILT_ISA::Places<Real>;
  using Stored = typename VectorOf<T, L::count>::type;
  const lbm::SILT_ISA::PlaceOrigin<Real> origin(links.corner, frame);
  const auto set = [&](auto&& distance) {
    for (int l = 0; l < links.padded; l += L::count) {
      const Stored found = __builtin_convertvector(distance(Places(links.place + l, origin)), Stored);
      __builtin_memcpy(q + l, &found, sizeof found);
    }
  };
  const SurfacePart<Real>& part = surface.parts[0];
  if (surface.count == 1)
    with_kind(part.kind, [&](auto kind) {
      set([&](const Places& at) {
        const LineLanes<Real, kind()> lines(part, at.r, at.c);
        return under_lip(distance_to(lines, part, surface.planes, past), lines, part, surface.planes);
      });
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

}  // namespace silt::coupler::SILT_ISA
