#pragma once
// The populations of a fluid go to the blocks of another cut, straight from rank to rank.
#include "lbm/fluid.hpp"

namespace silt::lbm {

/// Collective. Gives every cell of `to` what arrives there in `from`: two cuts of one domain for the same
/// ranks. A direction at a time, so that messages hold a nineteenth of the populations.
template <class T>
void move_populations(const Fluid<T>& from, Fluid<T>& to);

}  // namespace silt::lbm
