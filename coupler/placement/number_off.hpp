#pragma once
// Numbers things that lie on many ranks in an order that does not depend on which rank has which.
#include <cstdint>
#include <vector>

#include "parallel/messages.hpp"

namespace silt::coupler {

/// Collective. Returns for each of this rank's keys, which are sorted, below `range` and unlike all others on
/// any rank, how many keys of all ranks are smaller. Each rank counts a slice of the range: none holds more
/// than that.
std::vector<std::uint64_t> number_off(parallel::Messages&, const std::vector<std::uint64_t>& keys,
                                      std::uint64_t range);

}  // namespace silt::coupler
