#pragma once
// The dense pass: every cell of a range collides, in place. It never asks what a cell is: walls and bodies
// are put right afterwards (halo, cut_links).
#include "lbm/block.hpp"

namespace silt::lbm {

template <class T>
struct CollisionRates;

/// Collides with the block at `parity`; once all its cells are done the block is at the flipped parity, and
/// its row ends have been moved (block.hpp).
template <class T>
void stream_collide(Block<T>&, Parity parity, const CollisionRates<T>&, RowRange);

}  // namespace silt::lbm
