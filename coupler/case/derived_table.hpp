#pragma once
// What follows from a case: the numbers one wants to see before a run.
#include <string>

namespace silt::coupler {

struct Case;

/// Returns the bytes of the fluid's populations (one array, D3Q19, updated in place) and of the map of solid
/// cells.
double fluid_memory(const Case&);

/// Returns a table of lines "name   in the units of the case   in lattice units": cells, time step,
/// relaxation time, sizes and expected speeds of each kind of body, memory, output. For `silt check` and the
/// head of run.log.
std::string derived_table(const Case&);

}  // namespace silt::coupler
