#pragma once
// The dense kernel: every cell of a range collides, in place. It never asks what a cell is: walls and bodies
// are put right afterwards (halo, cut_links).
#include "lbm/block.hpp"
#include "lbm/collision.hpp"

namespace silt::lbm {

/// Rows [y0, y1) of the planes [z0, z1) of a block.
struct RowRange {
  int y0, y1, z0, z1;
};

/// Collides with the block at `parity`; once all its cells are done the block is at the flipped parity, and
/// its row ends have been moved (block.hpp).
template <class T>
void stream_collide(Block<T>&, Parity parity, const CollisionRates<T>&, RowRange);

/// "avx512", "avx2" or "portable": what this machine runs (SILT_ISA in the environment can choose a lesser
/// one).
const char* instruction_set();

}  // namespace silt::lbm
