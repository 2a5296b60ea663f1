#pragma once
// The distance along links, in units of a link, to the first part of a surface that they enter; its
// computation for kernels for a vector of links, or for one (SILT_SCALAR).
//
// Beside convex edges the surface is moved outwards by a lip (method-walls.md, "Edges"): within a cell of an
// edge under_lip() reduces wall distances by a height over |n.c|, n the normal of the face.
#include "cpu/isa.hpp"
#include "lbm/walls/cut_links.hpp"
#include "rigid/shapes/surface_kinds.hpp"
#ifdef SILT_BUILD
#include "lbm/walls/link_places.hpp"
#endif

namespace silt::coupler {

/// Links to measure, in whole vectors; places count from `corner`.
struct PlacedLinks {
  const std::uint32_t* place;
  int padded;
  lbm::Int3 corner;
};
/// Sets wall distances q, with the lip of bodies of one part (under_lip). For a surface that has moved past
/// an end of a link, distances range from -past to 1 + past, in links; 1 + past if the line misses it.
template <class Real, class T>
using SurfaceDistances = void (*)(const PlacedLinks&, const lbm::SurfaceFrame&,
                                  const rigid::SurfaceView<Real>&, Real past, T* q);
SILT_BUILDS(template <class Real, class T> SurfaceDistances<Real, T> surface_distances();)
/// Returns the kernel for this CPU.
template <class Real, class T>
SurfaceDistances<Real, T> distance_kernel() {
  return SILT_CHOSEN(surface_distances<Real, T>)();
}

}  // namespace silt::coupler

#ifdef SILT_BUILD
namespace silt::coupler::SILT_BUILD {

using rigid::SurfaceKind, rigid::SurfacePart, rigid::SurfaceView;
using rigid::SILT_BUILD::IntervalLanes, rigid::SILT_BUILD::LineLanes, rigid::SILT_BUILD::with_kind;

/// Returns where lines enter, within [-past, 1 + past]; 1 + past if they do not. An interval whose middle is
/// at or before 0 belongs to a part behind the cell, which the link misses.
template <class T>
SILT_DEVICE auto first_inside(const IntervalLanes<T>& i, T past) {
  using V = typename IntervalLanes<T>::V;
  const V end = V{} + (T(1) + past), t = (i.enter <= i.leave) & (i.enter + i.leave > T(0)) ? i.enter : end;
  return V(t < -past ? V{} - past : t > end ? end : t);
}

/// Returns where lines leave the hole of a tube, within [0, 1].
template <class T>
SILT_DEVICE auto last_inside(const IntervalLanes<T>& i) {
  using V = typename IntervalLanes<T>::V;
  return V(i.leave > T(0) ? i.leave > T(1) ? V{} + T(1) : i.leave : V{});
}

/// Returns the distance along links to one part.
template <SurfaceKind kind, class T>
SILT_DEVICE auto distance_to(const LineLanes<T, kind>& lines, const SurfacePart<T>& part,
                             const rigid::Plane<T>* planes, T past) {
  const auto inside = lines.inside(part, planes);
  if constexpr (kind == SurfaceKind::tube)
    return last_inside(inside);
  else
    return first_inside(inside, past);
}

/// Returns the distance to the nearest part. Each lane ignores parts beyond its line, so results do not
/// depend on other lanes.
template <class T>
SILT_DEVICE auto distance_to_any(const lbm::SILT_BUILD::Places<T>& at, const SurfaceView<T>& surface,
                                 T past) {
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

/// Height of the lip in cells, half a cell from an edge; least wall distance under it; least |n.c|.
inline constexpr double lip_height = 0.22, least_under_lip = 0.01, least_lip_slope = 0.3;

/// Returns wall distances reduced by the lip of the part that lines meet; lines with q = 1 may meet none.
template <SurfaceKind kind, class T>
SILT_DEVICE typename Lanes<T>::Real under_lip(const typename Lanes<T>::Real& q,
                                              const LineLanes<T, kind>& lines, const SurfacePart<T>& part,
                                              const rigid::Plane<T>* planes) {
  using V = typename Lanes<T>::Real;
  if constexpr (!has_edges(kind)) {
    return q;
  } else {
    const V p[3] = {lines.at(0, q), lines.at(1, q), lines.at(2, q)};
    const rigid::SILT_BUILD::NearestEdge<T> edge(std::integral_constant<SurfaceKind, kind>{}, p,
                                                 lines.direction(), part, planes);
    const V from_middle = T(2) * edge.distance - T(1);
    const V height = T(1) - (from_middle < T(0) ? -from_middle : from_middle);
    const V slope = edge.slope > T(least_lip_slope) ? edge.slope : V{} + T(least_lip_slope);
    const V lower = q - T(lip_height) * edge.share * height / slope;
    const V least = q < T(least_under_lip) ? q : V{} + T(least_under_lip);
    return (q < T(1)) & (height > T(0)) ? lower > least ? lower : least : q;
  }
}

/// Returns the distance to a body of one part, under its lip.
template <SurfaceKind kind, class T>
SILT_DEVICE auto distance_to_part(const lbm::SILT_BUILD::Places<T>& at, const SurfaceView<T>& surface,
                                  T past) {
  const SurfacePart<T>& part = surface.parts[0];
  const LineLanes<T, kind> lines(part, at.r, at.c);
  return under_lip(distance_to(lines, part, surface.planes, past), lines, part, surface.planes);
}

/// Returns the distance along a vector of links.
template <class T>
SILT_DEVICE typename Lanes<T>::Real distance_of(const std::uint32_t* place,
                                                const lbm::SILT_BUILD::PlaceOrigin<T>& origin,
                                                const SurfaceView<T>& surface, T past) {
  const lbm::SILT_BUILD::Places<T> at(place, origin);
  if (surface.count > 1) return distance_to_any(at, surface, past);
  typename Lanes<T>::Real found{};
  with_kind(surface.parts[0].kind, [&](auto kind) { found = distance_to_part<kind()>(at, surface, past); });
  return found;
}

}  // namespace silt::coupler::SILT_BUILD
#endif
