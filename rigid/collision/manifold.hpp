#pragma once
// Contact manifolds: the points of a contact with given normal, several for flat faces and parallel lines.
#include "rigid/bodies/contact.hpp"
#include "rigid/collision/deepest_direction.hpp"

namespace silt::rigid {

/// Appends the contact points with gap <= tolerance (lattice units), ordered by feature. The approach must be
/// the deepest; its point is always included. If faces face each other (ConvexCore::facing_outline) the
/// points are the corners of their common patch (Sutherland, Hodgman, CACM 17 (1974) 32); if a line lies over
/// a face, the ends of its part over the face; if two lines are nearly parallel, the ends of their common
/// length (method-bodies.md, Contact points).
void append_manifold(const ConvexCore& a, const ConvexCore& b, const Approach&, double tolerance,
                     std::vector<ContactPoint>& out);

/// Appends the contact points of a core with the half-space b below the plane through `origin` with unit
/// normal `outward`, within `tolerance`: vertices of a box or polyhedron, ends of a capsule, rim points of a
/// disc that lies flat, otherwise the lowest rim point, the lowest point of a sphere or ellipsoid.
void append_plane_manifold(const ConvexCore& a, const Vec3& origin, const Vec3& outward, double tolerance,
                           std::vector<ContactPoint>& out);

// ---- manifold_boxes.cpp: the same for boxes ----

void append_box_manifold(const ConvexCore& a, const ConvexCore& b, const Peak&, double tolerance,
                         std::vector<ContactPoint>& out);
void append_box_plane_manifold(const ConvexCore& a, const Vec3& origin, const Vec3& outward, double tolerance,
                               std::vector<ContactPoint>& out);

/// The code of a contact point of two boxes, from the features on which it lies. It is fixed to the bodies'
/// axes, so it persists while the same vertices, edges or faces touch.
inline std::uint32_t feature_id(const Feature& of_a, const Feature& of_b) {
  return of_a.code() * 27 + of_b.code();
}

/// Appends a point; of two points of one feature the deeper is kept.
void add_unique(std::vector<ContactPoint>& points, const ContactPoint& p);

/// The most points of a contact of two convex shapes, as many as for two box faces at 45 degrees.
inline constexpr std::size_t most_contact_points = 8;

/// Keeps at most most_contact_points: the deepest, and those furthest apart. Preserves the order.
void reduce_manifold(std::vector<ContactPoint>& points);

}  // namespace silt::rigid
