#pragma once
// Any bounded convex shape as a core swept by a sphere, with all that a search over directions asks of it.
// Sphere, capsule and box are oriented boxes, some of whose half edges may be zero, swept by a sphere: sphere
// = point + radius, capsule = segment + radius, box = box + 0. Every other shape is its own core, of radius
// 0. Distances and depths of the swept shapes are those of the cores less the radii.
#include "rigid/shapes/convex_shape.hpp"

namespace silt::rigid {

/// World frame of the query, lattice units. It refers to the shape.
struct ConvexCore : Placement {
  const ConvexShape* shape;
  Vec3 half;         // half widths of a box about the centre that it is in, along the axes
  double radius;     // of the sphere that sweeps the core
  bool is_polytope;  // also a point or a segment
  bool is_box;       // also a point or a segment

  template <class S>
  bool is() const {
    return std::holds_alternative<S>(*shape);
  }
  bool is_point() const { return is_box && half.isZero(0); }
  /// Says whether the core has neither edges nor faces.
  bool smooth() const { return is<Ellipsoid>() || is_point(); }
  bool curved() const { return !is_polytope; }
  bool is_solid_polytope() const { return is_polytope && half.minCoeff() > 0; }

  /// The point of the core furthest along n.
  Vec3 support(const Vec3& n) const;

  // ---- These ask the shape (rigid/shapes/README.md); what is taken where it does not tell is in the .cpp
  // ----

  /// Derivative of the supporting point by the unit direction n, the supporting feature kept: zero for
  /// polytopes.
  Mat3 support_derivative(const Vec3& n) const;
  /// Adds the circles of directions in which the supporting feature changes that are within `angle` (radian)
  /// of n, and the faces whose normals are within `angle` of n.
  void kinks(const Vec3& n, double angle, Kinks& out) const;
  /// Radius of a ball inside the core that touches its boundary at x, where unit n is an outward normal; 0 at
  /// edges and corners. At most the largest there is: 0 is always right, and costs the proof of a depth.
  double touching_ball(const Vec3& x, const Vec3& n) const;
  /// Says whether the core looks the same however it is turned about its third axis.
  bool is_revolved() const;
  /// A ball inside the core, near x, as large as it goes; of radius 0 where none is known.
  InnerBall inner_ball(const Vec3& x) const;
  /// The points of the core that are furthest along unit n, up to `slack` (lattice units).
  void touching_outline(const Vec3& n, double slack, ContactOutline& out) const;
  /// The face or the line of the core that looks along unit n, at whatever angle: the face of a polytope most
  /// nearly normal to n, a capsule's axis, the supporting point of what is curved.
  void facing_outline(const Vec3& n, ContactOutline& out) const;
  /// Adds the points that may touch a plane normal to unit n, in the order of their codes.
  void plane_points(const Vec3& n, std::vector<PlanePoint>& out) const;

  // ---- of a box ----

  /// 0 sphere, 1 capsule, 3 box.
  int extent() const { return (half.x() > 0) + (half.y() > 0) + (half.z() > 0); }
  /// Half the width along unit n.
  double reach(const Vec3& n) const {
    return half.x() * std::abs(axes.col(0).dot(n)) + half.y() * std::abs(axes.col(1).dot(n)) +
           half.z() * std::abs(axes.col(2).dot(n));
  }
  /// Returns the way from the nearest point of the core to x, in the core's axes: exactly 0 along an axis x
  /// is within.
  Vec3 outside(const Vec3& x) const {
    const Vec3 at = direction_B(x - centre);
    return at - at.cwiseMax(-half).cwiseMin(half);
  }
  /// Calls use(Feature) for every vertex, in the order of feature codes.
  template <class Use>
  void for_each_vertex(Use use) const {
    const int nx = half.x() > 0, ny = half.y() > 0, nz = half.z() > 0;
    for (int z = -nz; z <= nz; z += 2)
      for (int y = -ny; y <= ny; y += 2)
        for (int x = -nx; x <= nx; x += 2) use(Feature{{std::int8_t(x), std::int8_t(y), std::int8_t(z)}});
  }
  Vec3 vertex(const Feature& f) const { return vertex(Vec3(f.sign[0], f.sign[1], f.sign[2])); }
  Vec3 vertex(const Vec3& signs) const { return to_world(half.cwiseProduct(signs)); }
};

/// Returns the core of a shape that is no half-space.
ConvexCore convex_core(const ConvexShape&, const Pose&);

/// Says whether the codes of all features of a shape fit into half a contact's (those of a polyhedron of some
/// 10000 vertices; those of every other shape do).
bool has_codes(const ConvexShape&);

/// Returns the length that tolerances of rounding are relative to: sizes and distance of the pair.
double length_scale(const ConvexCore& a, const ConvexCore& b);

/// A direction with the distance of two cores along it or, less than 0, their depth in each other.
struct Peak {
  Vec3 normal;      // unit, from a to b
  double core_gap;  // core_separation along it
};

/// n . (support of b along -n - support of a along n): the distance of the two supporting planes of the cores
/// normal to unit n, from a to b; negative: they overlap along n. Its maximum over n is the distance of the
/// cores or minus their depth.
inline double core_separation(const ConvexCore& a, const ConvexCore& b, const Vec3& n) {
  return n.dot(b.support(-n) - a.support(n));
}
/// Returns the separation of two boxes, equal to that of cores but for rounding.
inline double box_separation(const ConvexCore& a, const ConvexCore& b, const Vec3& n) {
  return n.dot(b.centre - a.centre) - a.reach(n) - b.reach(n);
}

}  // namespace silt::rigid
