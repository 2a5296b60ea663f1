#pragma once
// Sphere, capsule and box are oriented boxes, some of whose half edges may be zero, swept
// by a sphere: sphere = point + radius, capsule = segment + radius, box = box + 0. Distances and depths of
// the swept shapes are those of the cores less the radii, so that one closed form serves all pairs.
#include "rigid/shapes/convex_shape.hpp"

namespace silt::rigid {

/// World frame of the query, lattice units.
struct RoundedBox {
  Vec3 centre;
  Mat3 axes;  // columns: the unit axes
  Vec3 half;  // half edges of the core, along the axes; 0 where it has no extent
  double radius;

  int extent() const {
    return (half.x() > 0) + (half.y() > 0) + (half.z() > 0);
  }  // 0 sphere, 1 capsule, 3 box
  /// Half the width of the core along unit n.
  double reach(const Vec3& n) const {
    return half.x() * std::abs(axes.col(0).dot(n)) + half.y() * std::abs(axes.col(1).dot(n)) +
           half.z() * std::abs(axes.col(2).dot(n));
  }
  Vec3 local(const Vec3& x) const { return axes.transpose() * (x - centre); }
  /// From the nearest point of the core to x, in the core's axes: exactly 0 along an axis x is within.
  Vec3 outside(const Vec3& x) const {
    const Vec3 at = local(x);
    return at - at.cwiseMax(-half).cwiseMin(half);
  }
  /// Calls use(Feature) for every vertex of the core, in the order of feature codes.
  template <class Use>
  void for_each_vertex(Use use) const {
    const int nx = half.x() > 0, ny = half.y() > 0, nz = half.z() > 0;
    for (int z = -nz; z <= nz; z += 2)
      for (int y = -ny; y <= ny; y += 2)
        for (int x = -nx; x <= nx; x += 2) use(Feature{{std::int8_t(x), std::int8_t(y), std::int8_t(z)}});
  }
  Vec3 vertex(const Feature& f) const { return vertex(Vec3(f.sign[0], f.sign[1], f.sign[2])); }
  Vec3 vertex(const Vec3& signs) const { return centre + axes * half.cwiseProduct(signs); }
};

/// Whether the shape is a box swept by a sphere, or a box.
bool has_rounded_box(const ConvexShape&);
/// std::invalid_argument for shapes that are none.
RoundedBox rounded_box(const ConvexShape&, const Pose&);

/// Length that tolerances of rounding are relative to: sizes and distance of the pair.
double length_scale(const RoundedBox& a, const RoundedBox& b);

/// Distance of the two supporting planes of the cores normal to unit n (from a to b); negative: they overlap
/// along n. Its maximum over n is the distance of the cores or minus their depth.
inline double core_separation(const RoundedBox& a, const RoundedBox& b, const Vec3& n) {
  return n.dot(b.centre - a.centre) - a.reach(n) - b.reach(n);
}

/// The identity of a contact point: the feature of either shape it lies on. The codes are those of the
/// shapes' own axes, so they stay while the same vertex, edge or face touches.
inline std::uint32_t feature_id(const Feature& of_a, const Feature& of_b) {
  return of_a.code() * 27 + of_b.code();
}

}  // namespace silt::rigid
