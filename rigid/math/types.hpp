#pragma once
// The vocabulary of rigid/: vectors, poses, ids. Lattice units everywhere (length: one cell, time: one
// fluid step, mass: reference density times a cell's volume). Frames in names where two are in play:
// _W world, _B body.
#include <Eigen/Dense>

#include <array>
#include <cstdint>
#include <limits>

namespace silt::rigid {

using Vec3 = Eigen::Vector3d;
using Mat3 = Eigen::Matrix3d;
/// Unit quaternion, body to world. Unaligned, so that its layout does not depend on the vector width a
/// translation unit was built for.
using Quat = Eigen::Quaternion<double, Eigen::DontAlign>;

struct Pose {
  Vec3 position = Vec3::Zero();
  Quat orientation = Quat::Identity();

  bool operator==(const Pose&) const = default;
  Vec3 to_world(const Vec3& x_B) const { return position + orientation * x_B; }
  Vec3 to_body(const Vec3& x_W) const { return orientation.conjugate() * (x_W - position); }
  /// Returns this pose as seen from another one of the same frame.
  Pose seen_from(const Pose& other) const {
    return {other.to_body(position), (other.orientation.conjugate() * orientation).normalized()};
  }
  /// The pose of a child given in this frame.
  Pose operator*(const Pose& child) const {
    return {to_world(child.position), (orientation * child.orientation).normalized()};
  }
};

using BodyId = std::uint64_t;
/// Ids from here on are walls: the half-spaces of the domain's sides, first_wall_id + 2 * axis + (upper
/// side), then the curved walls, from first_tube_id, in the order they were added. They are above every
/// body's id, so that a wall is always the second of a pair.
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
  /// It holds no point; `add` makes it grow.
  static BoundingBox empty() {
    constexpr double infinity = std::numeric_limits<double>::infinity();
    return {Vec3::Constant(infinity), Vec3::Constant(-infinity)};
  }
  static BoundingBox everything() { return {empty().upper, empty().lower}; }
  void add(const BoundingBox& other) {
    lower = lower.cwiseMin(other.lower);
    upper = upper.cwiseMax(other.upper);
  }
};

/// The velocities of a body.
struct Twist {
  Vec3 v = Vec3::Zero(), w = Vec3::Zero();  // of the centre; W
  Vec3 at(const Vec3& r) const { return v + w.cross(r); }
};

/// (1, a / 2) normalised: the Cayley map of the rotation vector a (radian), good to the third order of its
/// length.
inline Quat cayley(const Vec3& a) {
  return Quat(1, 0.5 * a[0], 0.5 * a[1], 0.5 * a[2]).normalized();
}

/// Returns the rotation by the angle between two vectors, neither of them zero, about the normal of both; of
/// opposite ones about some normal. Compiled in one place: Eigen solves for that normal, which takes a
/// compiler seconds.
Quat rotation_between(const Vec3& from, const Vec3& to);

/// Returns the rotation by the vector angle (radians about its own axis).
Quat rotation_by(const Vec3& angle);
/// Returns the shortest such vector of a rotation.
Vec3 angle_of(const Quat&);

/// The normal and two tangents.
inline std::array<Vec3, 3> contact_directions(const Vec3& n) {
  int smallest = 0;
  n.cwiseAbs().minCoeff(&smallest);
  const Vec3 t = n.cross(Vec3::Unit(smallest)).normalized();
  return {n, t, n.cross(t)};
}

}  // namespace silt::rigid
