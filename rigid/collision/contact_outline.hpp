#pragma once
// What of a convex core meets another in a direction: a point, a line or a flat polygon, with the features it
// is made of.
#include <cstdint>
#include <vector>

#include "rigid/collision/convex_core.hpp"

namespace silt::rigid {

/// One corner: a point. Two: a line. Three and more: a flat face, counter-clockwise or clockwise, or the end
/// of a cylinder, which is the disc through the corners. Codes are below 2^16 and unique for a shape; they
/// are those of Feature for boxes and capsules, and of the body's own frame for the others, so they stay
/// while the same feature touches.
struct ContactOutline {
  struct Corner {
    Vec3 x;
    std::uint32_t code, edge_code;  // edge: the one to the next corner
  };
  std::vector<Corner> corners;
  std::uint32_t code = 0;      // of what lies between the corners
  Vec3 normal = Vec3::Zero();  // outward, unit, of three corners and more
  Vec3 centre = Vec3::Zero();  // of a disc
  double disc_radius = 0;      // 0: not a disc

  std::size_t size() const { return corners.size(); }
  bool is_face() const { return size() > 2; }
  const Corner& next(std::size_t k) const { return corners[k + 1 < size() ? k + 1 : 0]; }
  /// How far from x to the face's plane, along unit n.
  double height(const Vec3& x, const Vec3& n) const { return normal.dot(corners[0].x - x) / normal.dot(n); }
};

/// Points of a circle that stand for the end of a cylinder, at fixed angles of its frame.
inline constexpr int rim_points = 8;

/// The points of the core that are furthest along unit n, up to `slack` (lattice units).
void touching_outline(const ConvexCore&, const Vec3& n, double slack, ContactOutline& out);
/// The face or the line of the core that looks along unit n, at whatever angle: the face of a polytope most
/// nearly normal to n; a cylinder's end (facing_end), its side's line (within 45 degrees), or its rim's
/// furthest point; a capsule's axis; the supporting point of an ellipsoid or a sphere's centre.
void facing_outline(const ConvexCore&, const Vec3& n, ContactOutline& out);
/// Side (-1 or 1) of the cylinder's end that lies flat against a plane normal to unit n, to within
/// flat_end_sine; 0: neither does, and only the furthest point of a rim can meet the plane: of points fixed
/// on the rim, those beside it would roll into the plane and be stopped while they are still above it.
int facing_end(const ConvexCore& cylinder, const Vec3& n);
/// Sine of the tilt up to which a cylinder's end is a face.
inline constexpr double flat_end_sine = 0.1;
/// Point of the rim of a cylinder's end (side -1 or 1) that is furthest along n, with its code.
ContactOutline::Corner lowest_rim_point(const ConvexCore& cylinder, int side, const Vec3& n);
/// The rim points of a cylinder's end.
void end_outline(const ConvexCore& cylinder, int side, ContactOutline& out);
/// Whether codes of all its vertices, edges and faces fit (some 10000 vertices; every other shape's do).
bool has_codes(const ConvexShape&);
/// Code of a vertex of a polyhedron.
inline std::uint32_t vertex_code(int vertex) {
  return vertex + 1;
}

}  // namespace silt::rigid
