#pragma once
// The surface moved outwards beside its convex edges (method-walls.md, "Edges"), for the kernel of wall
// distances, which is built once an instruction set: where a line meets a face s < 1 cells from the nearest
// edge, the wall distance is less by what `lip` says, divided by |n.c|, n the face's normal.
#include "coupler/mapping/surface_primitives.hpp"

namespace silt::coupler::SILT_ISA {

/// Cells by which the surface is moved half a cell from an edge; least wall distance that this leaves; least
/// |n.c| that is divided by.
inline constexpr double lip_height = 0.22, least_under_lip = 0.01, least_lip_slope = 0.3;

constexpr bool has_edges(PartKind kind) {
  using enum PartKind;
  return kind == box || kind == cylinder || kind == cone || kind == planes;
}

/// The neighbourhood of the point where a line meets a surface: the distance along the surface to the nearest
/// edge; |n.d|, with d the line's direction; and the share of a lip that the edge gets, sin^2 of the angle it
/// turns by (1 from a right angle on).
template <class T>
struct NearestEdge {
  using L = Lanes<T>;
  using V = typename L::Real;
  V distance = V{} + std::numeric_limits<T>::infinity(), slope{}, share = V{} + T(1);

  /// p is a point on the part, in its axes from its centre.
  template <PartKind kind>
  SILT_DEVICE NearestEdge(std::integral_constant<PartKind, kind>, const V (&p)[3], const V (&d)[3],
                          const SurfacePart<T>& part, const Plane<T>* planes) {
    static_assert(has_edges(kind));
    if constexpr (kind == PartKind::box)
      of_box(p, d, part);
    else if constexpr (kind == PartKind::planes)
      of_planes(p, d, planes + part.first_plane, planes + part.first_plane + part.planes);
    else
      of_rim(p, d, part, kind == PartKind::cone);
  }

 private:
  SILT_DEVICE void of_box(const V (&p)[3], const V (&d)[3], const SurfacePart<T>& part) {
    V depth{};
    for (int k = 0; k < 3; ++k) {
      const V other = part.size[k] - L::magnitude(p[k]);
      const auto nearer = k == 0 ? other == other : other < depth;
      if (k > 0) {
        const V second = nearer ? depth : other;
        distance = second < distance ? second : distance;
      }
      depth = nearer ? other : depth, slope = nearer ? L::magnitude(d[k]) : slope;
    }
  }
  /// Takes the rim at either end of a cylinder, or at the base of a cone, whose apex is up.
  SILT_DEVICE void of_rim(const V (&p)[3], const V (&d)[3], const SurfacePart<T>& part, bool tapers) {
    const T taper = tapers ? part.size[0] / (2 * part.size[2]) : T(0), slant = std::sqrt(1 + taper * taper);
    const V r = L::root(p[0] * p[0] + p[1] * p[1]), z = tapers ? -p[2] : L::magnitude(p[2]);
    const V end = part.size[2] - z;
    const V side = (tapers ? taper * (part.size[2] + z) : V{} + part.size[0]) - r;
    const auto on_end = end < side;
    const V outwards = (d[0] * p[0] + d[1] * p[1]) / r;
    distance = on_end ? part.size[0] - r : end * slant;
    slope = L::magnitude(on_end ? d[2] : (outwards + taper * d[2]) / slant);
  }
  /// The face is the plane that the point is next to; each other plane cuts it off somewhere.
  SILT_DEVICE void of_planes(const V (&p)[3], const V (&d)[3], const Plane<T>* first, const Plane<T>* end) {
    V least = distance, n[3] = {};
    const auto depth_under = [&](const T* m, T offset) {
      return offset - (m[0] * p[0] + m[1] * p[1] + m[2] * p[2]);
    };
    for (const Plane<T>* plane = first; plane < end; ++plane) {
      const V depth = depth_under(plane->normal, plane->offset);
      const auto nearer = depth < least;
      least = nearer ? depth : least;
      for (int k = 0; k < 3; ++k) n[k] = nearer ? V{} + plane->normal[k] : n[k];
    }
    slope = L::magnitude(n[0] * d[0] + n[1] * d[1] + n[2] * d[2]);
    for (const Plane<T>* plane = first; plane < end; ++plane) {
      const T* const m = plane->normal;
      const V cosine = n[0] * m[0] + n[1] * m[1] + n[2] * m[2], square = T(1) - cosine * cosine;
      const V found = depth_under(m, plane->offset) / L::root(square < T(0) ? V{} : square);
      const auto nearer = (square > T(1e-6)) & (found < distance);
      distance = nearer ? found : distance;
      share = nearer ? cosine > T(0) ? square : V{} + T(1) : share;
    }
  }
};

/// Wall distances with the lip of the part that lines meet at them; 1: they may not.
template <PartKind kind, class T>
SILT_DEVICE typename Lanes<T>::Real under_lip(const typename Lanes<T>::Real& q,
                                              const LineLanes<T, kind>& lines, const SurfacePart<T>& part,
                                              const Plane<T>* planes) {
  using V = typename Lanes<T>::Real;
  if constexpr (!has_edges(kind)) {
    return q;
  } else {
    const V p[3] = {lines.at(0, q), lines.at(1, q), lines.at(2, q)};
    const NearestEdge<T> edge(std::integral_constant<PartKind, kind>{}, p, lines.direction(), part, planes);
    const V from_middle = T(2) * edge.distance - T(1);
    const V height = T(1) - (from_middle < T(0) ? -from_middle : from_middle);
    const V slope = edge.slope > T(least_lip_slope) ? edge.slope : V{} + T(least_lip_slope);
    const V lower = q - T(lip_height) * edge.share * height / slope;
    const V least = q < T(least_under_lip) ? q : V{} + T(least_under_lip);
    return (q < T(1)) & (height > T(0)) ? lower > least ? lower : least : q;
  }
}

}  // namespace silt::coupler::SILT_ISA
