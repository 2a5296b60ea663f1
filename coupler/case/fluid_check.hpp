#pragma once
// Judges the fluid: its memory, viscosity, collision model and initial state.
#include "coupler/case/body_check.hpp"

namespace silt::coupler {

/// Reports relaxation times that are out of range or doubtful, with a time step that cures them, viscosities
/// (SI) that no fluid has, cell Reynolds numbers above those measured, more memory than the machine has, and
/// initial speeds that are too high. Nothing without a fluid.
void find_fluid_faults(const Case&, Findings&);

}  // namespace silt::coupler
