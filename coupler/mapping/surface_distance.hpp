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
/// Keeps those of the first n links, from one half of the directions, that cross an edge of the surface
/// (crossing_links.hpp); sets the distances at which they and the links from their other ends meet it.
/// Returns their number.
template <class T>
using KeepCrossings = std::uint32_t (*)(std::uint32_t* place, std::uint32_t n, lbm::Int3 corner,
                                        const lbm::SurfaceFrame&, const rigid::SurfaceView<T>&, T* begin,
                                        T* end);
SILT_BUILDS(template <class T> KeepCrossings<T> keep_crossings();)
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

/// Returns the direction that Components have packed.
SILT_DEVICE inline lbm::Int3 along(std::int32_t packed) {
  using lbm::SILT_BUILD::component;
  return {component(packed, 0), component(packed, 1), component(packed, 2)};
}

/// The distances along a vector of links from either end; which of the links cross an edge.
template <class T>
struct Crossings {
  typename Lanes<T>::Real begin, end;
  typename Lanes<T>::Mask cross;
};
/// Examines links between two cells: those cross that meet the surface from both ends, if their line does not
/// meet it beyond either one.
template <class T>
SILT_DEVICE Crossings<T> crossings_of(const std::uint32_t* place,
                                      const lbm::SILT_BUILD::PlaceOrigin<T>& origin,
                                      const SurfaceView<T>& surface) {
  using L = Lanes<T>;
  using V = typename L::Real;
  const V begin = distance_of(place, origin, surface, T(0));
  if (L::all(begin >= T(1))) return {begin, begin, begin < T(1)};
  std::uint32_t end[L::count], before[L::count], after[L::count];
  for (int k = 0; k < L::count; ++k) {
    const int i = lbm::place_direction(place[k]), back = lbm::opposite(i);
    const lbm::Int3 x = lbm::place_cell(place[k]), y = x + along(origin.packed[i]);
    end[k] = lbm::link_place(y, back), before[k] = lbm::link_place(x, back), after[k] = lbm::link_place(y, i);
  }
  const auto at = [&](const std::uint32_t* places) { return distance_of(places, origin, surface, T(0)); };
  const V from_end = at(end);
  const auto cross = (begin < T(1)) & (from_end < T(1)) & (at(before) == T(1)) & (at(after) == T(1));
  return {begin, from_end, typename L::Mask(cross)};
}

}  // namespace silt::coupler::SILT_BUILD
#endif
