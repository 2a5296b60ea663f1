#pragma once
// The dense pass: every cell of a range collides, in place. It never asks what a cell is: walls and bodies
// are put right afterwards (halo, cut_links).
#include <vector>

#include "cpu/isa.hpp"
#include "lbm/blocks/block.hpp"

namespace silt::lbm {

template <class T>
struct CollisionRates;

/// The speed of sound, 1/sqrt(3) cells a step: what is faster is no flow of this lattice, but on its way to
/// not a number. (At 0.4 the scheme's error is of the order of the flow itself; a cell beside a gap may be
/// that fast for a while and come back.)
inline constexpr double speed_of_sound = 0.57735026918962576;

/// A cell that was faster when a pass began, by its offset (Block::cell), and its speed, with that of the
/// force.
struct FastCell {
  std::ptrdiff_t cell;
  double speed;
};

/// The planes whose speeds a pass watches, each in one pass of `period`: it costs 3 % of a plane's collision.
struct WatchedPlanes {
  static constexpr int period = 8;
  int first;                     // z of one, 0 to period - 1
  std::vector<FastCell>& found;  // fast cells are appended, solid ones too
  int next(int z) const { return z + (first - z % period + period) % period; }
};

/// The kernel of a collision, as each build has it (stream_collide_kernel.cpp).
template <class T>
using CollideRows = void (*)(Block<T>&, Parity, const CollisionRates<T>&, RowRange, const WatchedPlanes&);
template <class T>
using TakeExcess = void (*)(Block<T>&, Parity);
SILT_BUILDS(template <class T> CollideRows<T> collide_rows(const CollisionRates<T>&);
            template <class T> TakeExcess<T> excess_kernel();)

/// Collides with the block at `parity`; once all its cells are done the block is at the flipped parity, and
/// its row ends have been moved (block.hpp).
template <class T>
void stream_collide(Block<T>& block, Parity parity, const CollisionRates<T>& rates, RowRange range,
                    const WatchedPlanes& watched) {
  const auto kernel_of = SILT_CHOSEN(collide_rows<T>);
  kernel_of(rates)(block, parity, rates, range, watched);
}

}  // namespace silt::lbm
