#pragma once
// What a contact search asks of a convex shape at a place: what of it meets another in a direction (a point,
// a line or a flat face, with the features it is made of), and where its boundary is not smooth.
#include <cstdint>
#include <vector>

#include "rigid/math/types.hpp"

namespace silt::rigid {

/// Where a shape is; world frame of the query, lattice units.
struct Placement {
  Vec3 centre;
  Mat3 axes;  // columns: the unit axes of the body

  Vec3 to_world(const Vec3& x_B) const { return centre + axes * x_B; }
  Vec3 direction_B(const Vec3& n) const { return axes.transpose() * n; }
};

/// Directions in which the boundary of a core is not smooth, near a given one; world frame, unit vectors.
struct Kinks {
  /// The directions n with n . axis = c. A straight edge (or a line of a cylinder's side) is normal to those
  /// with c = 0; where a cone's side meets its apex and its rim, c is the sine of its slope.
  struct Circle {
    Vec3 axis;
    double c = 0;
  };
  std::vector<Circle> circles;
  std::vector<Vec3> faces;  // outward normals
  void clear() {
    circles.clear();
    faces.clear();
  }
};

/// One corner: a point. Two: a line. Three and more: a flat face, counter-clockwise or clockwise, or a disc
/// through the corners. Codes are below 2^16 and unique for a shape; they are those of Feature for boxes and
/// capsules, and of the body's own frame for the others, so they stay while the same feature touches.
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
  double barrel_radius = 0;    // of the barrel about the third axis that a line lies on; 0: on none

  std::size_t size() const { return corners.size(); }
  bool is_face() const { return size() > 2; }
  const Corner& next(std::size_t k) const { return corners[k + 1 < size() ? k + 1 : 0]; }
  /// How far from x to the face's plane, along unit n.
  double height(const Vec3& x, const Vec3& n) const { return normal.dot(corners[0].x - x) / normal.dot(n); }
  void reset() {
    corners.clear();
    disc_radius = barrel_radius = 0;
  }
  void set_point(const Vec3& x, std::uint32_t point_code) {
    reset();
    corners.push_back({x, point_code, point_code});
    code = point_code;
  }
};

/// A point of a shape that may touch a plane.
struct PlanePoint {
  Vec3 x;
  std::uint32_t code;
  bool only_if_lowest = false;  // it moves over the surface, and counts only where no other is as low
};

}  // namespace silt::rigid
