#pragma once
// Judges densities: whether they can be in the units that the case has.
#include "coupler/case/body_check.hpp"

namespace silt::coupler {

/// Refuses densities that no step can take; warns of free bodies a fiftieth as heavy as the fluid or fifty
/// times as heavy, or too light for explicit coupling, and of densities (SI) that no matter has: what they
/// come to in g/cm3 is named.
void find_density_faults(const Case&, Findings&);

}  // namespace silt::coupler
