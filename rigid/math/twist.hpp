#pragma once
// Velocity and angular velocity of a body, rotations, and the directions of a contact.
#include <array>

#include "rigid/math/types.hpp"

namespace silt::rigid {

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
