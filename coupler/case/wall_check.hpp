#pragma once
// The part of check_case that looks at curved walls, and at bodies in them.
#include "coupler/case/body_check.hpp"
#include "coupler/case/body_spec.hpp"

namespace silt::coupler {

/// Refuses a tube that leaves no room for fluid or bodies, crosses a periodic border, or moves too fast.
void find_wall_faults(const Case&, Findings&);

/// Returns what is wrong with a body that at its start reaches further than `allowed` (cells) into a curved
/// wall, "" if it does not; `key` is what to change.
std::string fault_in_curved_walls(const Case&, const BodySpec&, const std::string& key, double allowed);

}  // namespace silt::coupler
