#pragma once
// The mass of cells that change sides (method.md, equations 46 and 47): a cell that a body covers leaves its
// deviation of density to the fluid around it, and one that a body has left takes it from there, so that
// bodies which move change no mass, wherever the sides of the domain are open.
#include "coupler/mapping/refill.hpp"
#include "rigid/math/exact_sum.hpp"

namespace silt::coupler {

/// The mass that cells of this rank get from their neighbours which changed sides, in quanta of
/// lbm/blocks/excess.hpp. They get it after they have collided: before that they would have to give up their
/// excess first, because the sum of both is rounded otherwise.
struct PassedMass {
  std::vector<lbm::LocalCell> cells;
  std::vector<std::int64_t> masses;
  rigid::FixedSum left = 0;  // in lbm::mass_quantum, for which there was no neighbour that stayed fluid
};

/// Collective over the ranks of neighbouring blocks, after refill(): covered cells still have what they held.
template <class T>
PassedMass pass_on_mass(lbm::Fluid<T>&, const std::vector<BlockMap>&, const ChangedCells&);

}  // namespace silt::coupler
