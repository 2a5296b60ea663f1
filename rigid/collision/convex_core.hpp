#pragma once
// Any bounded convex shape as a core swept by a sphere, with all that a search over directions asks of it.
// For a sphere, capsule or box it is the same core as rounded_box gives; cylinder, ellipsoid and polyhedron
// are their own cores, of radius 0.
#include <vector>

#include "rigid/collision/rounded_box.hpp"

namespace silt::rigid {

/// Directions in which the boundary of a core is not smooth, near a given one; world frame, unit vectors.
struct Kinks {
  std::vector<Vec3> edges;  // along straight edges (or lines of a cylinder's side) of the supporting feature
  std::vector<Vec3> faces;  // outward normals
  void clear() { edges.clear(), faces.clear(); }
};

/// World frame of the query, lattice units.
struct ConvexCore {
  enum class Kind : std::uint8_t { box, cylinder, ellipsoid, polyhedron };  // box: also a point or a segment

  Kind kind;
  Vec3 centre;
  Mat3 axes;                             // columns: the unit axes of the body
  Vec3 half;                             // half widths along the axes (of a polyhedron: of its frame's box)
  double radius;                         // of the sphere that sweeps the core
  const PolyhedronMesh* mesh = nullptr;  // of a polyhedron

  Vec3 to_world(const Vec3& x_B) const { return centre + axes * x_B; }
  Vec3 direction_B(const Vec3& n) const { return axes.transpose() * n; }
  bool is_point() const { return kind == Kind::box && half.isZero(0); }
  bool is_segment() const { return kind == Kind::box && half.x() == 0 && half.z() > 0; }
  /// Without edges and faces.
  bool smooth() const { return kind == Kind::ellipsoid || is_point(); }
  /// The point of the core furthest along n.
  Vec3 support(const Vec3& n) const;
  /// Derivative of the supporting point by the unit direction n, the supporting feature kept: zero for
  /// polytopes.
  Mat3 curvature(const Vec3& n) const;
  bool curved() const { return kind == Kind::cylinder || kind == Kind::ellipsoid; }
  /// The edges of the feature that supports n which are within `angle` (radian) of normal to n, and the faces
  /// whose normals are within `angle` of n.
  void kinks(const Vec3& n, double angle, Kinks& out) const;
  /// Radius of a ball inside the core that touches its boundary at x, where unit n is an outward normal; 0 at
  /// edges and corners. The largest there is, but of an ellipsoid (least half axis)^2 / (width along n): with
  /// |m| the norm sqrt(m.Am) and a the least half axis, |m||n| - m.An is half the square of a vector's norm,
  /// which is at least a^2 (1 - m.n).
  double touching_ball(const Vec3& x, const Vec3& n) const;
};

/// Not for a half-space. The core refers to the shape's mesh.
ConvexCore convex_core(const ConvexShape&, const Pose&);

/// As for rounded boxes: what tolerances of rounding are relative to.
double length_scale(const ConvexCore& a, const ConvexCore& b);

/// n . (support of b along -n - support of a along n): the separation of the cores along unit n.
inline double core_separation(const ConvexCore& a, const ConvexCore& b, const Vec3& n) {
  return n.dot(b.support(-n) - a.support(n));
}

}  // namespace silt::rigid
