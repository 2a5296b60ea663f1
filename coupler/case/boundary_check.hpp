#pragma once
// Judges the sides of the domain.
#include "coupler/case/body_check.hpp"

namespace silt::coupler {

/// "domain.boundary.z[0]", by the number of a side.
const char* side_key(int side);

/// Reports sides that are periodic on one side only; with a fluid inlets and walls that are too fast, walls
/// that move through themselves, inlets without an outlet, that point out of the domain or let nothing in,
/// and outlets of an impossible density.
void find_boundary_faults(const Case&, Findings&);

}  // namespace silt::coupler
