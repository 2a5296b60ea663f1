#pragma once
// The vorticity of the fluid, curl u, from differences of the velocities of cells.
#include "coupler/results/velocities_around.hpp"

namespace silt::coupler {

/// Returns the vorticity in a fluid cell, lattice units. Differences are central; beside what is not fluid
/// they are taken from the other side, exact for velocities that are quadratic along the axis where two cells
/// there are fluid, else of the first order; 0 between walls on both sides.
rigid::Vec3 vorticity(VelocitiesAround&, lbm::Int3 cell);

}  // namespace silt::coupler
