#pragma once
// Surfaces as the kernels of object mapping see them: the convex parts of a body, turned as the body is, in
// the precision of the kernel. And the kernel of wall distances, built once an instruction set.
#include <cstdint>

#include "lbm/cut_links.hpp"

namespace silt::coupler {

/// normal . x <= offset inside.
template <class T>
struct Plane {
  T normal[3], offset;
};

/// `sphere`: its axes are those of the world. `planes`: what lies behind all of them.
enum class PartKind : std::uint8_t { sphere, ellipsoid, box, capsule, cylinder, planes, hollow };

/// Lengths in cells, along the part's own axes; for an ellipsoid in its half axes, so that it is a ball.
template <class T>
struct SurfacePart {
  PartKind kind;
  T axes[3][3];  // rows: the part's axes in the world
  T centre[3];   // from the body's reference point
  T size[3];     // half edges; or radius, radius, half length
  T extent[3];   // half edges of a box around it
  std::uint32_t first_plane, planes;
};

/// All of a body. A line meets it where it meets the first part.
template <class T>
struct SurfaceView {
  const SurfacePart<T>* parts;
  int count;
  const Plane<T>* planes;
};

/// Sets the wall distances of links, whole vectors of them.
template <class Real, class T>
using SurfaceDistances = void (*)(const std::uint32_t* place, int padded, const lbm::SurfaceFrame&,
                                  lbm::Int3 corner, const SurfaceView<Real>&, T* q);
namespace portable {
template <class Real, class T>
SurfaceDistances<Real, T> surface_distances();
}
namespace avx2 {
template <class Real, class T>
SurfaceDistances<Real, T> surface_distances();
}
namespace avx512 {
template <class Real, class T>
SurfaceDistances<Real, T> surface_distances();
}

}  // namespace silt::coupler
