#pragma once
// The force of the fluid on a side of the domain, by momentum exchange over the links across it.
#include <span>

#include "rigid/math/types.hpp"

namespace silt::lbm {
template <class T>
class Fluid;
}

namespace silt::coupler {

struct BlockMap;

/// The force in the last step, lattice units: the sum of c (f out + f back) over the links across the upper
/// or lower side of an axis (README.md, equation 1). It is 0 where that is not a wall. Collective; summed in
/// fixed point.
template <class T>
rigid::Vec3 side_force(const lbm::Fluid<T>&, std::span<const BlockMap>, int axis, bool upper);

}  // namespace silt::coupler
