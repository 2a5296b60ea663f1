#pragma once
// The vocabulary of rigid/: vectors, poses, ids. Lattice units everywhere (length: one cell, time: one
// fluid step, mass: reference density times a cell's volume). Frames in names where two are in play:
// _W world, _B body.
#include <Eigen/Dense>
#include <cstdint>

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
  /// The same pose seen from another one of the same frame.
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

}  // namespace silt::rigid
