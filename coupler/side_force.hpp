#pragma once
// The force of the fluid on a side of the domain, by momentum exchange over the links across it.
#include <array>
#include <span>

#include "rigid/math/fixed_point.hpp"

namespace silt::lbm {
template <class T>
class Fluid;
}

namespace silt::coupler {

struct BlockMap;

/// This rank's share of the force in the last step, in lbm::link_quantum: the sum of c (f out + f back) over
/// its links across the upper or lower side of an axis (README.md, equation 1). It is 0 where that is not a
/// wall.
template <class T>
std::array<rigid::FixedSum, 3> side_force(const lbm::Fluid<T>&, std::span<const BlockMap>, int axis,
                                          bool upper);

}  // namespace silt::coupler
