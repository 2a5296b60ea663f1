#pragma once
// The sides of a domain that tests use most.
#include "lbm/blocks/domain.hpp"

namespace silt::lbm::testing {

inline const SideCondition periodic{}, no_slip{SideKind::bounce}, slip{SideKind::free_slip};

}  // namespace silt::lbm::testing
