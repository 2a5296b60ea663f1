#pragma once
// The shapes of bodies, in the body frame, whose origin is the centre of mass.
#include <variant>

#include "rigid/shapes/box.hpp"
#include "rigid/shapes/capsule.hpp"
#include "rigid/shapes/cylinder.hpp"
#include "rigid/shapes/ellipsoid.hpp"
#include "rigid/shapes/half_space.hpp"
#include "rigid/shapes/polyhedron.hpp"
#include "rigid/shapes/shape_fwd.hpp"
#include "rigid/shapes/sphere.hpp"
#include "rigid/shapes/triangle_mesh.hpp"
#include "rigid/shapes/tube.hpp"

namespace silt::rigid {

template <ConvexSolid... S>
using ConvexShapes = std::variant<S...>;

struct ConvexShape : ConvexShapes<Sphere, Box, Capsule, Cylinder, Ellipsoid, Polyhedron, HalfSpace> {
  using variant::variant;
};

/// Returns the point of the shape furthest along direction_B, a vector of any nonzero length.
Vec3 support(const ConvexShape&, const Vec3& direction_B);
/// Returns the part of the line origin + t direction inside the shape; none if the line misses it.
std::optional<LineInterval> line_interval(const ConvexShape&, const Vec3& origin_B, const Vec3& direction_B);
/// Returns the curvature tensor of the surface at x_B (on the surface, to rounding) with outward unit normal
/// n_B: symmetric, zero along the normal; its other eigenvalues are the principal curvatures, >= 0. None
/// where n_B is not the normal of a face or a side, so at an edge or a corner.
std::optional<Mat3> curvature(const ConvexShape&, const Vec3& x_B, const Vec3& n_B);
/// Returns whether the surface has a curvature everywhere, so neither edges nor corners.
bool is_smooth(const ConvexShape&);

struct Part {
  ConvexShape shape;
  Pose pose;  // part to body

  bool operator==(const Part&) const = default;
};

/// Returns the bounding box of one part of a body, in the frame of the body's pose.
BoundingBox part_box(const Part&, const Pose& body);
/// Returns the largest distance of a point of the part from the body's origin.
double reach(const Part&);

/// The union of parts, which may overlap (a star: three capsules crossed at the centre).
struct Compound {
  static constexpr std::string_view name = "compound";
  std::vector<Part> parts;

  bool contains(const Vec3& x) const;
  double signed_distance(const Vec3& x) const;
  BoundingBox bounding_box(const Pose&) const;
  MassProperties mass_properties() const;
  /// Returns the diameter of the sphere of equal volume.
  double least_width() const;
  Compound recentred(const Vec3& centre) const;
};

template <class... S>
std::variant<S..., Compound, Tube, Mesh> all_of(const std::variant<S...>&);

/// A convex shape, a union of convex shapes, a tube, or the solid bounded by a triangle mesh.
struct Shape : decltype(all_of(std::declval<ConvexShape>())) {
  using variant::variant;
  Shape(const ConvexShape& convex) : Shape(std::visit([](const auto& s) { return Shape(s); }, convex)) {}
};

std::string_view shape_name(const Shape&);  // "sphere", "box", "capsule", "cylinder", ...

/// Returns whether x_B is inside or on the surface.
bool contains(const Shape&, const Vec3& x_B);
/// Returns the distance to the surface, negative inside; for a compound the minimum over its parts (exact
/// outside, a lower bound in magnitude where parts overlap).
double signed_distance(const Shape&, const Vec3& x_B);
/// Returns the axis-aligned box in the world frame; infinite for a half-space, a tube and a hollow mesh.
BoundingBox bounding_box(const Shape&, const Pose&);
/// Returns the radius about the body frame's origin; infinite for half-spaces, tubes and hollow meshes.
double bounding_radius(const Shape&);
/// Closed forms, exact; for a compound those of the union of its parts, to a relative error of 1e-4.
MassProperties mass_properties(const Shape&);
/// Returns the least distance of two parallel planes that enclose the shape, or an estimate: for a compound
/// the diameter of the sphere of equal volume, for a mesh the least side of its box.
double least_width(const Shape&);
/// Returns the shape in the frame whose origin is its centre of mass `centre`.
Shape recentred(const Shape&, const Vec3& centre);
/// Returns the shape with all lengths multiplied by `factor`; not for half-spaces and tubes.
Shape scaled(const Shape&, double factor);
/// Returns whether the shape is a sphere, whose orientation has no influence.
bool is_sphere(const Shape&);
/// Returns whether the shape is infinite: a tube or a hollow mesh.
bool is_infinite(const Shape&);

/// Returns the convex parts: one for a convex shape, none for a tube or a mesh.
std::vector<Part> convex_parts(const Shape&);

/// Returns balls and points inside a shape that represent it in tests for overlap: exact for a sphere; for a
/// compound those of its parts; for a mesh its vertices.
std::vector<InnerBall> inner_balls(const Shape&);

}  // namespace silt::rigid
