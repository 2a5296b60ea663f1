#pragma once
// How long it takes to find the pressure that the loads of a start ask for (coupler/quiet_start.hpp).
#include <cstdint>

namespace silt {

struct Case;

/// Returns a number of steps: those of two crossings of the longest side by sound, of one along a periodic
/// axis. 0 where the case asks for none, where fluid or inlets do not begin at rest, and where nothing sets
/// off sound: no weight, spring or body force.
std::int64_t quiet_start_steps(const Case&);

/// Says whether the fluid, its inlets and what comes from another run begin at rest; with a fluid.
bool begins_at_rest(const Case&);

}  // namespace silt
