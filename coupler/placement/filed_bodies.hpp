#pragma once
// The bodies of a case whose positions stand in files, on the ranks they concern.
#include <vector>

#include "coupler/placement/given_bodies.hpp"

namespace silt::coupler {

/// Collective. Adds those that this rank owns or that reach near it, in the order of ids. Each rank reads a
/// slice of each file and sends every body to the ranks it concerns, in rounds of `at_once` a rank: none ever
/// has more than its slice, and its own. CaseError on every rank names file and point.
void add_filed_bodies(const Case&, Surroundings&, std::vector<GivenBody>&, std::size_t at_once = 1 << 16);

}  // namespace silt::coupler
