#pragma once
// Momentum and kinetic energy of the fluid and of the bodies, as the report gives them.
#include "coupler/simulation.hpp"

namespace silt::coupler {

/// Lattice units; of the free bodies, and of the cells that are fluid.
struct MotionTotals {
  rigid::Vec3 bodies_momentum = rigid::Vec3::Zero(), fluid_momentum = rigid::Vec3::Zero();
  double bodies_energy = 0, fluid_energy = 0;  // kinetic, rotation included
};

/// Collective. The same to the bit on any number of ranks.
MotionTotals motion_totals(const Simulation&);

}  // namespace silt::coupler
