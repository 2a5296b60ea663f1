#pragma once
// The mass of cells that change sides (method.md, equations 46 and 47): a cell that a body covers leaves its
// deviation of density to the fluid around it, and one that a body has left takes it from there, so that
// bodies which move change no mass, wherever the sides of the domain are open.
#include "coupler/mapping/refill.hpp"
#include "rigid/math/exact_sum.hpp"

namespace silt::coupler {

/// Cells that changed sides, and their neighbours, give up their excess, before anybody reads them or gives
/// them mass.
template <class T>
void take_excess_around(lbm::Fluid<T>&, const std::vector<BlockMap>&, const ChangedCells&);

/// Collective over the ranks of neighbouring blocks, after refill(): covered cells still have what they held.
/// Returns the mass, in lbm::mass_quantum, that this rank's cells could not pass on, because no neighbour was
/// fluid and still is.
template <class T>
rigid::FixedSum pass_on_mass(lbm::Fluid<T>&, const std::vector<BlockMap>&, const ChangedCells&);

}  // namespace silt::coupler
