#pragma once
// The parts of a shape in the axes of its body, and turned with the body: by the processor, or by a device,
// which then needs the orientation alone.
#include <cstdint>

#include "cpu/device_code.hpp"
#include "rigid/shapes/surface_kinds.hpp"

namespace silt::rigid {

/// One part of a shape (SurfacePart): lengths in cells.
struct ShapePart {
  SurfaceKind kind;
  bool turns;         // false: a ball, whose axes are always those of the world
  double axes[3][3];  // rows: the part's axes in the body
  double scale[3];    // by which coordinates along its axes are multiplied
  double centre[3];   // along its axes, scaled; of a ball along the axes of the body
  double size[3], extent[3];
  std::uint32_t first_plane, planes;
};

/// All parts of a shape. Its planes do not change as it turns.
template <class T>
struct ShapeView {
  const ShapePart* parts = nullptr;
  int count = 0;
  const Plane<T>* planes = nullptr;
  bool operator==(const ShapeView&) const = default;
};

/// The orientation of a body: a unit quaternion.
struct Turn {
  double w, x, y, z;
  bool operator==(const Turn&) const = default;
};

/// The rotation from the axes of a body to those of the world.
struct Rotation {
  double m[3][3];

  [[gnu::always_inline]] SILT_DEVICE explicit Rotation(const Turn& q) {
    const double x = 2 * q.x, y = 2 * q.y, z = 2 * q.z;
    const double wx = x * q.w, wy = y * q.w, wz = z * q.w, xx = x * q.x, xy = y * q.x, xz = z * q.x;
    const double yy = y * q.y, yz = z * q.y, zz = z * q.z;
    m[0][0] = 1 - (yy + zz), m[0][1] = xy - wz, m[0][2] = xz + wy;
    m[1][0] = xy + wz, m[1][1] = 1 - (xx + zz), m[1][2] = yz - wx;
    m[2][0] = xz - wy, m[2][1] = yz + wx, m[2][2] = 1 - (xx + yy);
  }
};

/// Returns a part as the body has turned.
template <class T>
[[gnu::always_inline]] SILT_DEVICE inline SurfacePart<T> turned(const ShapePart& part, const Rotation& turn) {
  const auto dot = [](const double* a, const double* b) { return a[0] * b[0] + (a[1] * b[1] + a[2] * b[2]); };
  SurfacePart<T> found{};
  found.kind = part.kind, found.first_plane = part.first_plane, found.planes = part.planes;
  for (int k = 0; k < 3; ++k) {
    found.centre[k] = T(part.turns ? part.centre[k] : dot(turn.m[k], part.centre));
    found.size[k] = T(part.size[k]), found.extent[k] = T(part.extent[k]);
    for (int d = 0; d < 3; ++d)
      found.axes[k][d] = T(part.turns ? part.scale[k] * dot(part.axes[k], turn.m[d]) : k == d ? 1.0 : 0.0);
  }
  return found;
}

}  // namespace silt::rigid
