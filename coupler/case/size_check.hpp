#pragma once
// Judges the sizes of bodies: against the cells, the domain and each other.
#include "coupler/case/body_check.hpp"

namespace silt::coupler {

/// Refuses bodies that the lattice does not see, that are larger than the domain (of those that move), or
/// that would meet themselves across a periodic border; warns of those with fewer cells across than their
/// drag needs and, without a fluid, of specks in a domain that they cannot be meant for. Both name the size
/// or the cell that cures it.
void find_size_faults(const Case&, Findings&);

}  // namespace silt::coupler
