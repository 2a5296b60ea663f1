#pragma once
// The least rotation from one direction to another.
#include "rigid/math/types.hpp"

namespace silt::rigid {

/// Returns the rotation by the angle between two vectors, neither of them zero, about the normal of both; of
/// opposite ones about some normal. Compiled in one place: Eigen solves for that normal, which takes a
/// compiler seconds.
Quat rotation_between(const Vec3& from, const Vec3& to);

}  // namespace silt::rigid
