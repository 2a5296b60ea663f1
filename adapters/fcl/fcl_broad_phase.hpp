#pragma once
// "fcl": FCL's dynamic tree of boxes.
#include <memory>

#include "rigid/collision/broad_phase.hpp"

namespace silt::adapters {

std::unique_ptr<rigid::BroadPhase> make_fcl_broad_phase();

}  // namespace silt::adapters
