#pragma once
// Any bounded convex shape as a core swept by a sphere, with all that a search over directions asks of it.
// For a sphere, capsule or box it is the same core as rounded_box gives; every other shape is its own core,
// of radius 0.
#include "rigid/collision/rounded_box.hpp"
#include "rigid/shapes/contact_outline.hpp"
#include "rigid/shapes/solid.hpp"

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
  /// Without edges and faces.
  bool smooth() const { return is<Ellipsoid>() || is_point(); }
  bool curved() const { return !is_polytope; }
  bool is_solid_polytope() const { return is_polytope && half.minCoeff() > 0; }

  /// The point of the core furthest along n.
  Vec3 support(const Vec3& n) const;
  /// Derivative of the supporting point by the unit direction n, the supporting feature kept: zero for
  /// polytopes.
  Mat3 support_derivative(const Vec3& n) const;
  /// The circles of directions in which the supporting feature changes that are within `angle` (radian) of n,
  /// and the faces whose normals are within `angle` of n.
  void kinks(const Vec3& n, double angle, Kinks& out) const;
  /// Radius of a ball inside the core that touches its boundary at x, where unit n is an outward normal; 0 at
  /// edges and corners.
  double touching_ball(const Vec3& x, const Vec3& n) const;
  /// Whether it looks the same however it is turned about its third axis.
  bool is_revolved() const;
  /// A ball inside the core, near x; of radius 0 where none is known.
  InnerBall inner_ball(const Vec3& x) const;
  /// The points of the core that are furthest along unit n, up to `slack` (lattice units).
  void touching_outline(const Vec3& n, double slack, ContactOutline& out) const;
  /// The face or the line of the core that looks along unit n, at whatever angle: the face of a polytope most
  /// nearly normal to n, a capsule's axis, the supporting point of what is curved.
  void facing_outline(const Vec3& n, ContactOutline& out) const;
  /// The points that may touch a plane normal to unit n, in the order of their codes.
  void plane_points(const Vec3& n, std::vector<PlanePoint>& out) const;
};

/// Not for a half-space.
ConvexCore convex_core(const ConvexShape&, const Pose&);

/// Whether the codes of all its features fit into half a contact's (a polyhedron of some 10000 vertices;
/// every other shape's do).
bool has_codes(const ConvexShape&);

/// As for rounded boxes: what tolerances of rounding are relative to.
double length_scale(const ConvexCore& a, const ConvexCore& b);

/// n . (support of b along -n - support of a along n): the separation of the cores along unit n.
inline double core_separation(const ConvexCore& a, const ConvexCore& b, const Vec3& n) {
  return n.dot(b.support(-n) - a.support(n));
}

}  // namespace silt::rigid
