#pragma once
// A bounded convex shape as a core swept by a sphere, with the operations of a search over directions.
// Sphere, capsule and box are oriented boxes with zero or more nonzero half edges, swept by a sphere: sphere
// = point + radius, capsule = segment + radius, box = box + 0. Every other shape is its own core of radius 0.
// Distances and penetration depths of the shapes are those of the cores less the radii.
#include "rigid/shapes/shape.hpp"

namespace silt::rigid {

/// In the world frame of the query, lattice units. It refers to the shape, which must outlive it.
struct ConvexCore : Placement {
  const ConvexShape* shape;
  Vec3 half;         // half widths of a bounding box about the centre, along the axes
  double radius;     // of the sphere that sweeps the core
  bool is_polytope;  // true for points and segments, too
  bool is_box;       // true for points and segments, too

  template <class S>
  bool is() const {
    return std::holds_alternative<S>(*shape);
  }
  bool is_point() const { return is_box && half.isZero(0); }
  /// Returns whether the core has neither edges nor faces.
  bool smooth() const { return is<Ellipsoid>() || is_point(); }
  bool curved() const { return !is_polytope; }
  bool is_solid_polytope() const { return is_polytope && half.minCoeff() > 0; }

  /// Returns the support point along n.
  Vec3 support(const Vec3& n) const;

  // ---- Defined by the shape (rigid/shapes/README.md); defaults are in the .cpp ----

  /// Returns the derivative of the support point by unit n on the same feature; zero for polytopes.
  Mat3 support_derivative(const Vec3& n) const;
  /// Adds the great circles within `angle` (radians) of n on which the supporting feature changes, and the
  /// faces whose normals are within `angle` of n.
  void kinks(const Vec3& n, double angle, Kinks& out) const;
  /// Returns a lower bound of the radius of the largest ball inside the core that touches its boundary at x,
  /// where unit n is an outward normal; 0 at edges and corners. Smaller values are valid.
  double touching_ball(const Vec3& x, const Vec3& n) const;
  /// Returns whether the core is a solid of revolution about its third axis.
  bool is_revolved() const;
  /// Returns a large ball inside the core near x; radius 0 if none is known.
  InnerBall inner_ball(const Vec3& x) const;
  /// Writes the outline of the points furthest along unit n, within `slack` (lattice units).
  void touching_outline(const Vec3& n, double slack, ContactOutline& out) const;
  /// Writes the outline that faces n at any angle: for a polytope the face whose normal is closest to n, for
  /// a capsule the axis, for other curved cores the support point.
  void facing_outline(const Vec3& n, ContactOutline& out) const;
  /// Adds the points that may touch a plane normal to unit n, ordered by code.
  void plane_points(const Vec3& n, std::vector<PlanePoint>& out) const;

  // ---- boxes only ----

  /// Returns the number of nonzero half edges: 0 sphere, 1 capsule, 3 box.
  int extent() const { return (half.x() > 0) + (half.y() > 0) + (half.z() > 0); }
  /// Returns half the width along unit n.
  double reach(const Vec3& n) const {
    return half.x() * std::abs(axes.col(0).dot(n)) + half.y() * std::abs(axes.col(1).dot(n)) +
           half.z() * std::abs(axes.col(2).dot(n));
  }
  /// Returns the vector from the nearest point of the core to x, in the core's axes; a component is exactly 0
  /// where x is within the core's extent along that axis.
  Vec3 outside(const Vec3& x) const {
    const Vec3 at = direction_B(x - centre);
    return at - at.cwiseMax(-half).cwiseMin(half);
  }
  /// Calls use(Feature) for every vertex in the order of feature codes.
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

/// Returns the core of any shape except a half-space.
ConvexCore convex_core(const ConvexShape&, const Pose&);

/// Returns whether all feature codes of a shape fit into half a contact's: up to some 10000 vertices.
bool has_codes(const ConvexShape&);

/// Returns the length to which rounding tolerances are relative, from the sizes and the distance of the pair.
double length_scale(const ConvexCore& a, const ConvexCore& b);

/// A direction and the signed distance of two cores along it; negative: overlap.
struct Peak {
  Vec3 normal;      // unit, from a to b
  double core_gap;  // core_separation along the normal
};

/// Returns n . (support of b along -n - support of a along n): the signed distance, from a to b, of the
/// supporting planes normal to unit n; negative where the cores overlap along n. Its maximum over n is the
/// distance of the cores or minus their penetration depth.
inline double core_separation(const ConvexCore& a, const ConvexCore& b, const Vec3& n) {
  return n.dot(b.support(-n) - a.support(n));
}
/// The same for two boxes, equal up to rounding.
inline double box_separation(const ConvexCore& a, const ConvexCore& b, const Vec3& n) {
  return n.dot(b.centre - a.centre) - a.reach(n) - b.reach(n);
}

}  // namespace silt::rigid
