#include "rigid/math/twist.hpp"

namespace silt::rigid {

Quat rotation_between(const Vec3& from, const Vec3& to) {
  return Quat::FromTwoVectors(from, to);
}

}  // namespace silt::rigid
