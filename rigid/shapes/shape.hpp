#pragma once
// The shapes a body can have, in the body frame: origin at the centre of mass.
#include <span>
#include <string_view>
#include <variant>
#include <vector>

#include "rigid/math/types.hpp"
#include "rigid/shapes/polyhedron.hpp"

namespace silt::rigid {

struct Sphere {
  double radius;
};
struct Box {
  Vec3 half_edges;
};
/// A segment along the body's z axis from -half_length to +half_length, swept by a sphere.
struct Capsule {
  double radius, half_length;
};
/// Round about the body's z axis, flat ends at -half_length and +half_length.
struct Cylinder {
  double radius, half_length;
};
struct Ellipsoid {
  Vec3 half_axes;
};
/// Convex. The mesh is never null; its origin is the body's.
struct Polyhedron {
  std::shared_ptr<const PolyhedronMesh> mesh;
};
/// All points with normal . x_B <= 0: the normal points out of the solid. Only for walls: infinite mass.
struct HalfSpace {
  Vec3 normal;
};

/// All points at least `radius` from the body's z axis, without end: a wall round about what is inside. Only
/// for walls: infinite mass, not convex, so no collision backend sees it (tube_contacts).
struct Tube {
  double radius;
};

/// What a collision backend sees: convex, in one piece.
using ConvexShape = std::variant<Sphere, Box, Capsule, Cylinder, Ellipsoid, Polyhedron, HalfSpace>;

struct Part {
  ConvexShape shape;
  Pose pose;  // part to body
};
/// The union of its parts, which may overlap (a star: three capsules crossed at the centre).
struct Compound {
  std::vector<Part> parts;
};

using Shape = std::variant<Sphere, Box, Capsule, Cylinder, Ellipsoid, Polyhedron, HalfSpace, Compound, Tube>;

struct BoundingBox {
  Vec3 lower, upper;
};

/// Of unit density, about the centre of mass, in the axes of the shape as given.
struct MassProperties {
  double volume;
  Vec3 centre;
  Mat3 inertia;
};

std::string_view shape_name(const Shape&);  // "sphere", "box", "capsule", "cylinder", ...

/// x_B inside or on the surface.
bool contains(const Shape&, const Vec3& x_B);
/// Distance to the surface, negative inside. For a compound: the minimum over its parts (exact outside; a
/// lower bound in magnitude inside overlapping parts).
double signed_distance(const Shape&, const Vec3& x_B);
/// Smallest t in [0, t_max] with origin + t direction on the surface, for an origin outside; t_max where
/// there is none. Exact (closed form) for every convex shape and the tube. direction need not be a unit
/// vector.
double ray_distance(const Shape&, const Vec3& origin_B, const Vec3& direction_B, double t_max);
/// Axis-aligned, in the world frame, of the shape at the pose; infinite for a half-space and a tube.
BoundingBox bounding_box(const Shape&, const Pose&);
/// About the origin of the body frame; infinite for a half-space and a tube.
double bounding_radius(const Shape&);
/// Furthest distance of a point of a part from the body's origin.
double reach(const Part&);
/// The point of a convex shape furthest along direction_B.
Vec3 support(const ConvexShape&, const Vec3& direction_B);
/// Closed forms, exact; for a compound those of the union of its parts, relative error <= 1e-4,
/// deterministic.
MassProperties mass_properties(const Shape&);
/// The same shape expressed about its centre of mass (only a compound or a polyhedron can differ); `centre`
/// is subtracted.
Shape recentred(const Shape&, const Vec3& centre);
/// A half-space or a sphere looks the same from anywhere on an axis: where orientation cannot matter.
bool is_sphere(const Shape&);

/// Axis-aligned box of one part of a body, in the frame the body's pose is given in.
BoundingBox part_box(const Part&, const Pose& body);
/// The convex parts of any shape (one for a convex shape itself, none for a tube).
std::vector<Part> convex_parts(const Shape&);

}  // namespace silt::rigid
