#pragma once
// The strain rate of the fluid in a cell, which its populations hold.
#include "coupler/case/fluid_spec.hpp"
#include "coupler/fluid_fields.hpp"

namespace silt::coupler {

/// S : S of what arrives at a cell, from S = -3/(2 tau) [sum_i c_i c_i (g_i - g_i^eq) + (u F + F u) / 2]
/// (Chapman-Enskog with the force of Guo, Zheng, Shi 2002; reference density 1).
double strain_rate_squared(const FluidFields&, const lbm::Moments&, const FluidSpec&);

}  // namespace silt::coupler
