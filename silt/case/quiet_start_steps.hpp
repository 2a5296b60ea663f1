#pragma once
// The number of steps that a quiet start takes (silt/quiet_start.hpp).
#include <cstdint>

namespace silt {

struct Case;

/// Returns the number of steps: sound crosses the longest side twice, or once along a periodic axis. 0 if the
/// case turns it off, if fluid or inlets do not start at rest, or without a weight, spring or body force.
std::int64_t quiet_start_steps(const Case&);

/// Returns whether the fluid, its inlets and a continued state start at rest; needs a fluid.
bool begins_at_rest(const Case&);

}  // namespace silt
