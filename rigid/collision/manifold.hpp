#pragma once
// The points of a contact follow from its direction: faces and lines that lie flat touch in more than one.
#include "rigid/bodies/contact.hpp"
#include "rigid/collision/deepest_direction.hpp"

namespace silt::rigid {

/// Appends the points of a contact, ordered by feature, those with gap <= tolerance (lattice units). The
/// approach must be the deepest there is, and its point is always among them. Where faces look at each other
/// (ConvexCore::facing_outline) the points are the corners of their common patch (Sutherland, Hodgman, CACM
/// 17 (1974) 32), where a line lies over a face the ends of its part over it, where two lines are nearly
/// parallel the ends of their common length (method-bodies.md, Contact points).
void append_manifold(const ConvexCore& a, const ConvexCore& b, const Approach&, double tolerance,
                     std::vector<ContactPoint>& out);

/// Appends those points of a core that are within `tolerance` of the plane through `origin` with unit
/// `outward` normal (out of the solid half-space b): the vertices of a box or polyhedron, the ends of a
/// capsule, the rim points of a disc that lies flat, else the lowest of its rim, the lowest point of a sphere
/// or an ellipsoid.
void append_plane_manifold(const ConvexCore& a, const Vec3& origin, const Vec3& outward, double tolerance,
                           std::vector<ContactPoint>& out);

// ---- manifold_boxes.cpp: what the two above do for boxes ----

void append_box_manifold(const ConvexCore& a, const ConvexCore& b, const Peak&, double tolerance,
                         std::vector<ContactPoint>& out);
void append_box_plane_manifold(const ConvexCore& a, const Vec3& origin, const Vec3& outward, double tolerance,
                               std::vector<ContactPoint>& out);

/// The identity of a contact point of two boxes: the feature of either that it lies on. The codes are those
/// of the shapes' own axes, so they stay while the same vertex, edge or face touches.
inline std::uint32_t feature_id(const Feature& of_a, const Feature& of_b) {
  return of_a.code() * 27 + of_b.code();
}

/// Appends a point; of two of the same feature the deeper stays.
void add_unique(std::vector<ContactPoint>& points, const ContactPoint& p);

/// Two convex shapes touch in no more points: a face of two boxes turned by 45 degrees has as many.
inline constexpr std::size_t most_contact_points = 8;

/// Leaves at most most_contact_points: the deepest, and those furthest from each other. Keeps the order.
void reduce_manifold(std::vector<ContactPoint>& points);

}  // namespace silt::rigid
