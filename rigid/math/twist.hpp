#pragma once
// Velocity and angular velocity of a body, and the directions of a contact.
#include <array>

#include "rigid/math/types.hpp"

namespace silt::rigid {

struct Twist {
  Vec3 v = Vec3::Zero(), w = Vec3::Zero();  // of the centre; W
  Vec3 at(const Vec3& r) const { return v + w.cross(r); }
};

/// The normal and two tangents.
inline std::array<Vec3, 3> contact_directions(const Vec3& n) {
  int smallest = 0;
  n.cwiseAbs().minCoeff(&smallest);
  const Vec3 t = n.cross(Vec3::Unit(smallest)).normalized();
  return {n, t, n.cross(t)};
}

}  // namespace silt::rigid
