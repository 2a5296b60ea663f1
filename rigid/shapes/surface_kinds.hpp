#pragma once
// The kinds of surface of a body's convex parts, as kernels use them: rotated with the body, in the kernel's
// precision. Kernels, which are built once for each instruction set, also get the intervals of lines inside a
// kind (one line a lane) and the nearest edge. Lines start within a few cells of the part; without branches;
// a shape's line_interval (solid.hpp) serves any line.
#include <cstdint>
#include <limits>
#include <type_traits>

#include "cpu/device_code.hpp"
#ifdef SILT_BUILD
#include "cpu/lanes.hpp"
#endif

namespace silt::rigid {

/// A plane of a convex part: normal . x <= offset inside.
template <class T>
struct Plane {
  T normal[3], offset;
};

/// `sphere`: its axes are those of the world. `planes`: the intersection of half-spaces.
/// `tube`: all points outside an infinite cylinder.
enum class SurfaceKind : std::uint8_t { sphere, ellipsoid, box, capsule, cylinder, planes, tube };
/// Returns whether the part has convex edges; for `planes`, whether it may have (a single plane has none).
constexpr bool has_edges(SurfaceKind kind) {
  using enum SurfaceKind;
  return kind == box || kind == cylinder || kind == planes;
}

/// One part: lengths in cells along its own axes; for an ellipsoid in units of its half axes.
template <class T>
struct SurfacePart {
  SurfaceKind kind;
  T axes[3][3];  // rows: the part's axes in the world
  T centre[3];   // relative to the body's reference point
  T size[3];     // half edges; or radius, radius, half length
  T extent[3];   // half edges of a box around it
  std::uint32_t first_plane, planes;
};

/// All parts of a body. A line meets the body where it first meets a part.
template <class T>
struct SurfaceView {
  const SurfacePart<T>* parts;
  int count;
  const Plane<T>* planes;
};

}  // namespace silt::rigid

#ifdef SILT_BUILD
namespace silt::rigid::SILT_BUILD {

/// Intervals of line parameters; enter > leave where a line misses.
template <class T>
struct IntervalLanes {
  using V = typename Lanes<T>::Real;
  V enter, leave;

  SILT_DEVICE static V smaller(const V& a, const V& b) { return a < b ? a : b; }
  SILT_DEVICE static V larger(const V& a, const V& b) { return a > b ? a : b; }
  /// Returns the intersection of both intervals. A NaN bound (a line in the plane of a face) is ignored.
  SILT_DEVICE IntervalLanes within(const IntervalLanes& o) const {
    return {larger(o.enter, enter), smaller(o.leave, leave)};
  }
  /// Returns the union of the intervals of two shapes whose union is convex.
  SILT_DEVICE IntervalLanes joined(const IntervalLanes& o) const {
    const auto here = enter <= leave, there = o.enter <= o.leave;
    return {there ? here ? smaller(enter, o.enter) : o.enter : enter,
            there ? here ? larger(leave, o.leave) : o.leave : leave};
  }
};

/// Lines o + t d in a part's axes, relative to its centre.
template <class T, SurfaceKind kind>
class LineLanes {
 public:
  using L = Lanes<T>;
  using V = typename L::Real;
  using Interval = IntervalLanes<T>;
  using Part = SurfacePart<T>;

  /// r and c are origin and direction in the world's axes, relative to the body's reference point.
  SILT_DEVICE LineLanes(const Part& part, const V (&r)[3], const V (&c)[3]) {
    for (int k = 0; k < 3; ++k)
      if constexpr (kind == SurfaceKind::sphere) {
        o_[k] = r[k] - part.centre[k], d_[k] = c[k];
      } else {
        const T *const axis = part.axes[k], centre = part.centre[k];
        o_[k] = (axis[0] * r[0] + axis[1] * r[1] + axis[2] * r[2]) - centre;
        d_[k] = axis[0] * c[0] + axis[1] * c[1] + axis[2] * c[2];
      }
  }

  /// Returns coordinate k of the points at t.
  SILT_DEVICE V at(int k, const V& t) const { return o_[k] + t * d_[k]; }
  SILT_DEVICE const V (&direction() const)[3] { return d_; }

  /// Returns lines without a point -past <= t <= 1 + past in the part's box, by separation along an axis.
  SILT_DEVICE typename L::Mask beyond(const Part& part, T past) const {
    const T half = T(0.5) + past;
    const auto along = [&](int k) {
      return L::magnitude(o_[k] + T(0.5) * d_[k]) > part.extent[k] + half * L::magnitude(d_[k]);
    };
    return along(0) | along(1) | along(2);
  }

  SILT_DEVICE Interval inside(const Part& part, const Plane<T>* planes) const {
    const T* const size = part.size;
    if constexpr (kind == SurfaceKind::sphere || kind == SurfaceKind::ellipsoid) {
      return ball(T(0), size[0]);
    } else if constexpr (kind == SurfaceKind::box) {
      return slab(0, size[0]).within(slab(1, size[1])).within(slab(2, size[2]));
    } else if constexpr (kind == SurfaceKind::capsule) {
      return barrel(size[0])
          .within(slab(2, size[2]))
          .joined(ball(size[2], size[0]))
          .joined(ball(-size[2], size[0]));
    } else if constexpr (kind == SurfaceKind::cylinder) {
      return barrel(size[0]).within(slab(2, size[2]));
    } else if constexpr (kind == SurfaceKind::planes) {
      return clipped(planes + part.first_plane, part.planes);
    } else {
      static_assert(kind == SurfaceKind::tube);
      return barrel(size[0]);
    }
  }

 private:
  static constexpr T infinity = std::numeric_limits<T>::infinity();

  /// Solves a t^2 + 2 b t + c <= 0 for a >= 0.
  SILT_DEVICE static Interval between_roots(const V& a, const V& b, const V& c) {
    const V discriminant = b * b - a * c, s = L::root(discriminant < T(0) ? V{} : discriminant);
    const auto outside = kind == SurfaceKind::tube ? c >= T(0) : c > T(0);           // the surface is solid
    const V parallel = outside ? V{} + infinity : V{} - infinity, per_a = T(1) / a;  // a may be 0
    const V enter = a > T(0) ? (-b - s) * per_a : parallel, leave = a > T(0) ? (s - b) * per_a : -parallel;
    return {discriminant < T(0) ? V{} + infinity : enter, discriminant < T(0) ? V{} - infinity : leave};
  }
  /// The ball about height z of the third axis.
  SILT_DEVICE Interval ball(T z, T radius) const {
    const V h = o_[2] - z;
    return between_roots(d_[0] * d_[0] + d_[1] * d_[1] + d_[2] * d_[2],
                         o_[0] * d_[0] + o_[1] * d_[1] + h * d_[2],
                         (o_[0] * o_[0] + o_[1] * o_[1] + h * h) - radius * radius);
  }
  /// The infinite cylinder about the third axis.
  SILT_DEVICE Interval barrel(T radius) const {
    return between_roots(d_[0] * d_[0] + d_[1] * d_[1], o_[0] * d_[0] + o_[1] * d_[1],
                         (o_[0] * o_[0] + o_[1] * o_[1]) - radius * radius);
  }
  /// The slab between two planes across axis k.
  SILT_DEVICE Interval slab(int k, T half_width) const {
    const V along = d_[k] < T(0) ? -o_[k] : o_[k], slowness = T(1) / L::magnitude(d_[k]);
    return Interval{V{} - infinity, V{} + infinity}.within(
        {(-half_width - along) * slowness, (half_width - along) * slowness});
  }
  /// The intersection of the half-spaces of all faces.
  SILT_DEVICE Interval clipped(const Plane<T>* planes, std::uint32_t n) const {
    Interval all{V{} - infinity, V{} + infinity};
    for (const Plane<T>* p = planes; p < planes + n; ++p) {
      const T* const m = p->normal;
      const V depth = p->offset - (m[0] * o_[0] + m[1] * o_[1] + m[2] * o_[2]);
      const V speed = m[0] * d_[0] + m[1] * d_[1] + m[2] * d_[2], t = depth / speed;
      all.enter = speed < T(0) ? Interval::larger(t, all.enter) : all.enter;
      all.leave = speed > T(0) ? Interval::smaller(t, all.leave) : all.leave;
      all.leave = (speed == T(0)) & (depth < T(0)) ? V{} - infinity : all.leave;
    }
    return all;
  }

  V o_[3], d_[3];
};

/// The surroundings of the point where a line of direction d meets a surface of normal n: the distance along
/// the surface to the nearest edge; |n.d|; and the edge's weight, sin^2 of its angle (at most a right one).
template <class T>
struct NearestEdge {
  using L = Lanes<T>;
  using V = typename L::Real;
  V distance = V{} + std::numeric_limits<T>::infinity(), slope{}, share = V{} + T(1);

  /// p is a point on the part's surface, in its axes relative to its centre.
  template <SurfaceKind kind>
  SILT_DEVICE NearestEdge(std::integral_constant<SurfaceKind, kind>, const V (&p)[3], const V (&d)[3],
                          const SurfacePart<T>& part, const Plane<T>* planes) {
    static_assert(has_edges(kind));
    if constexpr (kind == SurfaceKind::box)
      of_box(p, d, part);
    else if constexpr (kind == SurfaceKind::planes)
      of_planes(p, d, planes + part.first_plane, planes + part.first_plane + part.planes);
    else
      of_rim(p, d, part);
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
  /// Considers the rims at both ends of a cylinder.
  SILT_DEVICE void of_rim(const V (&p)[3], const V (&d)[3], const SurfacePart<T>& part) {
    const V r = L::root(p[0] * p[0] + p[1] * p[1]);
    const V end = part.size[2] - L::magnitude(p[2]), side = part.size[0] - r;
    const auto on_end = end < side;
    const V outwards = (d[0] * p[0] + d[1] * p[1]) / r;
    distance = on_end ? part.size[0] - r : end;
    slope = L::magnitude(on_end ? d[2] : outwards);
  }
  /// The face is that of the nearest plane; the other planes cut it off.
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

/// Calls use(std::integral_constant<SurfaceKind, kind>{}).
template <class F>
SILT_DEVICE void with_kind(SurfaceKind kind, F&& use) {
  using enum SurfaceKind;
  switch (kind) {
    case sphere:
      return use(std::integral_constant<SurfaceKind, sphere>{});
    case ellipsoid:
      return use(std::integral_constant<SurfaceKind, ellipsoid>{});
    case box:
      return use(std::integral_constant<SurfaceKind, box>{});
    case capsule:
      return use(std::integral_constant<SurfaceKind, capsule>{});
    case cylinder:
      return use(std::integral_constant<SurfaceKind, cylinder>{});
    case planes:
      return use(std::integral_constant<SurfaceKind, planes>{});
    case tube:
      return use(std::integral_constant<SurfaceKind, tube>{});
  }
}

}  // namespace silt::rigid::SILT_BUILD
#endif
