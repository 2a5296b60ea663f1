#pragma once
// "bullet": Bullet's narrow phase in double precision.
#include <memory>

#include "rigid/collision/collision_backend.hpp"

namespace silt::adapters {

/// Throws std::runtime_error where the Bullet found at run time does not compute in double precision.
void check_bullet_precision();

/// Throws std::runtime_error where the Bullet found at run time does not compute in double precision.
std::unique_ptr<rigid::CollisionBackend> make_bullet_backend();

}  // namespace silt::adapters
