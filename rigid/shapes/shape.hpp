#pragma once
// The shapes a body can have, in the body frame: origin at the centre of mass.
#include "rigid/shapes/compound.hpp"
#include "rigid/shapes/triangle_mesh.hpp"
#include "rigid/shapes/tube.hpp"

namespace silt::rigid {

template <class... S>
std::variant<S..., Compound, Tube, Mesh> all_of(const std::variant<S...>&);

/// A convex shape, a union of such, a tube, or what a surface of triangles encloses.
struct Shape : decltype(all_of(std::declval<ConvexShape>())) {
  using variant::variant;
  Shape(const ConvexShape& convex) : Shape(std::visit([](const auto& s) { return Shape(s); }, convex)) {}
};

std::string_view shape_name(const Shape&);  // "sphere", "box", "capsule", "cylinder", ...

/// x_B inside or on the surface.
bool contains(const Shape&, const Vec3& x_B);
/// Distance to the surface, negative inside. For a compound: the minimum over its parts (exact outside; a
/// lower bound in magnitude inside overlapping parts).
double signed_distance(const Shape&, const Vec3& x_B);
/// Axis-aligned, in the world frame, of the shape at the pose; infinite for a half-space, a tube and a hollow
/// mesh.
BoundingBox bounding_box(const Shape&, const Pose&);
/// Returns the radius about the origin of the body frame; infinite for a half-space, a tube and a hollow
/// mesh.
double bounding_radius(const Shape&);
/// Closed forms, exact; for a compound those of the union of its parts, relative error <= 1e-4,
/// deterministic.
MassProperties mass_properties(const Shape&);
/// Returns the least distance of two parallel planes that touch the shape, or a length near it: for a
/// compound the diameter of the sphere of its volume, for a mesh the least side of its box.
double least_width(const Shape&);
/// Returns the shape about its centre of mass, `centre`, which is subtracted.
Shape recentred(const Shape&, const Vec3& centre);
/// Returns the shape with every length of it `factor` times as long; it must not be a half-space or a tube.
Shape scaled(const Shape&, double factor);
/// A half-space or a sphere looks the same from anywhere on an axis: where orientation cannot matter.
bool is_sphere(const Shape&);
/// Says whether the shape is a tube or a hollow mesh: solid all around, without end.
bool is_endless(const Shape&);

/// The convex parts of any shape (one for a convex shape itself, none for a tube or a mesh).
std::vector<Part> convex_parts(const Shape&);

/// Balls and points inside a shape that together stand for it: exact for a sphere; for a compound those of
/// its parts; of a mesh its corners.
std::vector<InnerBall> inner_balls(const Shape&);

}  // namespace silt::rigid
