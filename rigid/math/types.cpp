#include "rigid/math/types.hpp"

#include "rigid/math/elementary.hpp"

namespace silt::rigid {

Quat rotation_between(const Vec3& from, const Vec3& to) {
  return Quat::FromTwoVectors(from, to);
}

Quat rotation_by(const Vec3& angle) {
  const double size = angle.norm();
  if (size == 0) return Quat::Identity();
  const Vec3 v = elementary::sin(0.5 * size) / size * angle;
  return Quat(elementary::cos(0.5 * size), v[0], v[1], v[2]);
}

Vec3 angle_of(const Quat& rotation) {
  const double sine = rotation.vec().norm(), cosine = rotation.w();
  if (sine == 0) return Vec3::Zero();
  const double half = cosine < 0 ? elementary::atan2(-sine, -cosine) : elementary::atan2(sine, cosine);
  return 2 * half / sine * rotation.vec();
}

}  // namespace silt::rigid
