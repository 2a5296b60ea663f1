#pragma once
// What a run may begin with, in lattice units.

namespace silt::coupler {

struct Case;
class FluidFields;

/// Puts the fluid of a case into its initial state, `fluid.initial`; the flow must be fresh (at rest).
void set_initial_flow(const Case&, FluidFields&);

}  // namespace silt::coupler
