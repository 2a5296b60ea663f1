#pragma once
// "fcl": the Flexible Collision Library with libccd.
#include <memory>

#include "rigid/collision/collision_backend.hpp"

namespace silt::adapters {

std::unique_ptr<rigid::CollisionBackend> make_fcl_backend();

}  // namespace silt::adapters
