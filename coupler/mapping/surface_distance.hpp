#pragma once
// The distance along links, in units of a link, to the first part of a surface that they enter: for a vector
// of links at a time, or for one (SILT_SCALAR).
#include "coupler/mapping/edge_lip.hpp"
#include "lbm/walls/link_places.hpp"

namespace silt::coupler::SILT_ISA {

/// Returns where lines enter, within [-past, 1 + past]; 1 + past where they do not. A line whose interval has
/// its middle at or before 0 misses the convex part, which lies behind it.
template <class T>
SILT_DEVICE auto first_inside(const IntervalLanes<T>& i, T past) {
  using V = typename IntervalLanes<T>::V;
  const V end = V{} + (T(1) + past), t = (i.enter <= i.leave) & (i.enter + i.leave > T(0)) ? i.enter : end;
  return V(t < -past ? V{} - past : t > end ? end : t);
}

/// Returns where lines from the hole of a hollow leave it, within [0, 1].
template <class T>
SILT_DEVICE auto last_inside(const IntervalLanes<T>& i) {
  using V = typename IntervalLanes<T>::V;
  return V(i.leave > T(0) ? i.leave > T(1) ? V{} + T(1) : i.leave : V{});
}

/// Returns the distance of links to one part.
template <PartKind kind, class T>
SILT_DEVICE auto distance_to(const LineLanes<T, kind>& lines, const SurfacePart<T>& part,
                             const Plane<T>* planes, T past) {
  const auto inside = lines.inside(part, planes);
  if constexpr (is_hollow(kind))
    return last_inside(inside);
  else
    return first_inside(inside, past);
}

/// Returns the distance to the nearest part. Each lane leaves out parts beyond its own line, so its result
/// does not depend on the other lanes.
template <class T>
SILT_DEVICE auto distance_to_any(const lbm::SILT_ISA::Places<T>& at, const SurfaceView<T>& surface, T past) {
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

/// Returns the distance to a body of one part, under its lip.
template <PartKind kind, class T>
SILT_DEVICE auto distance_to_part(const lbm::SILT_ISA::Places<T>& at, const SurfaceView<T>& surface, T past) {
  const SurfacePart<T>& part = surface.parts[0];
  const LineLanes<T, kind> lines(part, at.r, at.c);
  return under_lip(distance_to(lines, part, surface.planes, past), lines, part, surface.planes);
}

}  // namespace silt::coupler::SILT_ISA
