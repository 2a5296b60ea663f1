#pragma once
// What follows from a case: the numbers one wants to see before a run.
#include <string>

namespace silt::coupler {

struct Case;

/// Returns the speed at which a sphere falls or rises steadily in unbounded fluid, by the drag law of
/// Schiller and Naumann (1933), C_D = 24/Re (1 + 0.15 Re^0.687). Lattice units; density relative to the
/// fluid's; negative never.
double terminal_velocity(double diameter, double density, double gravity, double kinematic_viscosity);

/// Returns the bytes of the fluid's populations (one array, D3Q19, updated in place) and of the map of solid
/// cells.
double fluid_memory(const Case&);

/// Returns a table of lines "name   in the units of the case   in lattice units": cells, time step,
/// relaxation time, sizes and expected speeds of each kind of body, memory, output. For `silt check` and the
/// head of run.log.
std::string derived_table(const Case&);

}  // namespace silt::coupler
