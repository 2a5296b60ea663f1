#pragma once
// Vectors, poses and ids of rigid/, in lattice units (length: one cell; time: one fluid step; mass: reference
// density times a cell's volume). Suffixes name frames: _W world, _B body.
#include <Eigen/Dense>

#include <array>
#include <cstdint>
#include <limits>

namespace silt::rigid {

using Vec3 = Eigen::Vector3d;
using Mat3 = Eigen::Matrix3d;
/// Unit quaternion, body to world. Unaligned: the same layout for every vector width.
using Quat = Eigen::Quaternion<double, Eigen::DontAlign>;

struct Pose {
  Vec3 position = Vec3::Zero();
  Quat orientation = Quat::Identity();

  bool operator==(const Pose&) const = default;
  Vec3 to_world(const Vec3& x_B) const { return position + orientation * x_B; }
  Vec3 to_body(const Vec3& x_W) const { return orientation.conjugate() * (x_W - position); }
  /// Returns this pose relative to another pose given in the same frame.
  Pose relative_to(const Pose& other) const {
    return {other.to_body(position), (other.orientation.conjugate() * orientation).normalized()};
  }
  /// Returns the pose of a child whose pose is given relative to this one.
  Pose operator*(const Pose& child) const {
    return {to_world(child.position), (orientation * child.orientation).normalized()};
  }
};

using BodyId = std::uint64_t;
/// Ids of walls: the domain's sides are first_wall_id + 2 * axis + (upper side); curved walls follow from
/// first_tube_id in the order they were added. They exceed every body's id: a wall is the second of a pair.
inline constexpr BodyId first_wall_id = BodyId{1} << 63;
inline constexpr BodyId first_tube_id = first_wall_id + 6;
inline bool is_wall(BodyId id) {
  return id >= first_wall_id;
}

/// An axis-aligned box.
struct BoundingBox {
  Vec3 lower, upper;
  bool operator==(const BoundingBox&) const = default;

  static BoundingBox around(const Vec3& centre, const Vec3& half) { return {centre - half, centre + half}; }
  /// Returns a box without points, to be extended by `add`.
  static BoundingBox empty() {
    constexpr double infinity = std::numeric_limits<double>::infinity();
    return {Vec3::Constant(infinity), Vec3::Constant(-infinity)};
  }
  static BoundingBox everything() { return {empty().upper, empty().lower}; }
  /// Returns whether a point is in the box or on its surface.
  bool contains(const Vec3& x) const {
    return (x.array() >= lower.array()).all() && (x.array() <= upper.array()).all();
  }
  void add(const BoundingBox& other) {
    lower = lower.cwiseMin(other.lower);
    upper = upper.cwiseMax(other.upper);
  }
};

/// Linear and angular velocity of a body.
struct Twist {
  Vec3 v = Vec3::Zero(), w = Vec3::Zero();  // of the centre; W
  Vec3 at(const Vec3& r) const { return v + w.cross(r); }
};

/// Returns the Cayley map of the rotation vector a (radians), (1, a / 2) normalised, exact to third order.
inline Quat cayley(const Vec3& a) {
  return Quat(1, 0.5 * a[0], 0.5 * a[1], 0.5 * a[2]).normalized();
}

/// Returns the rotation from one nonzero vector's direction to the other's, about their common normal; for
/// opposite vectors about some normal. Defined in types.cpp, since Eigen's solver takes seconds to compile.
Quat rotation_between(const Vec3& from, const Vec3& to);

/// Returns the rotation by a rotation vector (axis times angle in radians).
Quat rotation_by(const Vec3& angle);
/// Returns the shortest rotation vector of a rotation.
Vec3 angle_of(const Quat&);

/// Returns the normal n and two unit tangents.
inline std::array<Vec3, 3> contact_directions(const Vec3& n) {
  int smallest = 0;
  n.cwiseAbs().minCoeff(&smallest);
  const Vec3 t = n.cross(Vec3::Unit(smallest)).normalized();
  return {n, t, n.cross(t)};
}

}  // namespace silt::rigid
