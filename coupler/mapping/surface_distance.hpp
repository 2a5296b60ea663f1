#pragma once
// The distance along links, in units of a link, to the first part of a surface that they enter; and for
// kernels how it is found, for a vector of links at a time or for one (SILT_SCALAR).
//
// Beside its convex edges the surface is moved outwards, by a lip (method-walls.md, "Edges"): where a line
// meets a face s < 1 cells from the nearest edge, the wall distance is less by what `under_lip` says, divided
// by |n.c|, n the face's normal.
#include "cpu/isa.hpp"
#include "lbm/walls/cut_links.hpp"
#include "rigid/shapes/surface_kinds.hpp"
#ifdef SILT_ISA
#include "lbm/walls/link_places.hpp"
#endif

namespace silt::coupler {

/// Links whose wall distances are wanted, whole vectors of them: places that count from a cell.
struct PlacedLinks {
  const std::uint32_t* place;
  int padded;
  lbm::Int3 corner;
};
/// Sets the wall distances of links, with the lip of bodies of one part (under_lip). They are found up to
/// `past` before and after the link, in units of it, of a surface that has moved past one of the link's ends;
/// 1 + past for a line that does not meet it there.
template <class Real, class T>
using SurfaceDistances = void (*)(const PlacedLinks&, const lbm::SurfaceFrame&,
                                  const rigid::SurfaceView<Real>&, Real past, T* q);
SILT_BUILDS(template <class Real, class T> SurfaceDistances<Real, T> surface_distances();)
/// The build that runs here.
template <class Real, class T>
SurfaceDistances<Real, T> distance_kernel() {
  return SILT_CHOSEN(surface_distances<Real, T>)();
}

}  // namespace silt::coupler

#ifdef SILT_ISA
namespace silt::coupler::SILT_ISA {

using rigid::SurfaceKind, rigid::SurfacePart, rigid::SurfaceView;
using rigid::SILT_ISA::IntervalLanes, rigid::SILT_ISA::LineLanes, rigid::SILT_ISA::with_kind;

/// Returns where lines enter, within [-past, 1 + past]; 1 + past where they do not. A line whose interval has
/// its middle at or before 0 misses the convex part, which lies behind it.
template <class T>
SILT_DEVICE auto first_inside(const IntervalLanes<T>& i, T past) {
  using V = typename IntervalLanes<T>::V;
  const V end = V{} + (T(1) + past), t = (i.enter <= i.leave) & (i.enter + i.leave > T(0)) ? i.enter : end;
  return V(t < -past ? V{} - past : t > end ? end : t);
}

/// Returns where lines from the hole of a tube leave it, within [0, 1].
template <class T>
SILT_DEVICE auto last_inside(const IntervalLanes<T>& i) {
  using V = typename IntervalLanes<T>::V;
  return V(i.leave > T(0) ? i.leave > T(1) ? V{} + T(1) : i.leave : V{});
}

/// Returns the distance of links to one part.
template <SurfaceKind kind, class T>
SILT_DEVICE auto distance_to(const LineLanes<T, kind>& lines, const SurfacePart<T>& part,
                             const rigid::Plane<T>* planes, T past) {
  const auto inside = lines.inside(part, planes);
  if constexpr (kind == SurfaceKind::tube)
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

/// Cells by which the surface is moved half a cell from an edge; least wall distance that this leaves; least
/// |n.c| that is divided by.
inline constexpr double lip_height = 0.22, least_under_lip = 0.01, least_lip_slope = 0.3;

/// Wall distances with the lip of the part that lines meet at them; 1: they may not.
template <SurfaceKind kind, class T>
SILT_DEVICE typename Lanes<T>::Real under_lip(const typename Lanes<T>::Real& q,
                                              const LineLanes<T, kind>& lines, const SurfacePart<T>& part,
                                              const rigid::Plane<T>* planes) {
  using V = typename Lanes<T>::Real;
  if constexpr (!has_edges(kind)) {
    return q;
  } else {
    const V p[3] = {lines.at(0, q), lines.at(1, q), lines.at(2, q)};
    const rigid::SILT_ISA::NearestEdge<T> edge(std::integral_constant<SurfaceKind, kind>{}, p,
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
SILT_DEVICE auto distance_to_part(const lbm::SILT_ISA::Places<T>& at, const SurfaceView<T>& surface, T past) {
  const SurfacePart<T>& part = surface.parts[0];
  const LineLanes<T, kind> lines(part, at.r, at.c);
  return under_lip(distance_to(lines, part, surface.planes, past), lines, part, surface.planes);
}

}  // namespace silt::coupler::SILT_ISA
#endif
