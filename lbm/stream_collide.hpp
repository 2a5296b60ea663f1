#pragma once
// The dense pass: every cell of a range collides, in place. It never asks what a cell is: walls and bodies
// are put right afterwards (halo, cut_links).
#include "lbm/block.hpp"

namespace silt::lbm {

template <class T>
struct CollisionRates;

/// The planes whose speeds a pass looks at: each in one pass of `period`. To look costs 2 to 4 % of a plane's
/// collision.
struct WatchedPlanes {
  static constexpr int period = 8;
  int first = 0;  // z of one, 0 to period - 1
  int next(int z) const { return z + (first - z % period + period) % period; }
};

/// Collides with the block at `parity`; once all its cells are done the block is at the flipped parity, and
/// its row ends have been moved (block.hpp). Returns the square of the largest speed that a cell of
/// the watched planes had before, solid cells included; a speed that is not a number does not count.
template <class T>
double stream_collide(Block<T>&, Parity parity, const CollisionRates<T>&, RowRange,
                      const WatchedPlanes& = {});

}  // namespace silt::lbm
