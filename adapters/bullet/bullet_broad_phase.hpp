#pragma once
// "bullet": the dynamic tree of boxes beneath Bullet's btDbvtBroadphase.
#include <memory>

#include "rigid/collision/broad_phase.hpp"

namespace silt::adapters {

/// Throws std::runtime_error where the Bullet found at run time does not compute in double precision.
std::unique_ptr<rigid::BroadPhase> make_bullet_broad_phase();

}  // namespace silt::adapters
