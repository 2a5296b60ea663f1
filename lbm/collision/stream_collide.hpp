#pragma once
// The dense pass: collides every cell of a range in place, fluid or solid. Walls and bodies are corrected
// afterwards (halo, cut_links).
#include <vector>

#include "cpu/isa.hpp"
#include "lbm/blocks/block.hpp"

namespace silt::lbm {

template <class T>
struct CollisionRates;

/// The speed of sound, 1/sqrt(3) cells per step. A faster cell is outside the range of the method and about
/// to diverge. (At 0.4 the error of the scheme is as large as the flow, but a cell in a gap may reach that
/// speed for a short time and recover.)
inline constexpr double speed_of_sound = 0.57735026918962576;

/// A cell faster than sound when a pass began: its Block::cell, and its speed with half the force.
struct FastCell {
  std::ptrdiff_t cell;
  double speed;
};

/// The planes whose speeds a pass checks, one in `period`: this costs 3 % of the collision of a plane.
struct WatchedPlanes {
  static constexpr int period = 8;
  int first;                     // z of one of them, 0 to period - 1
  std::vector<FastCell>& found;  // receives fast cells, solid ones too
  int next(int z) const { return z + (first - z % period + period) % period; }
};

/// The collision kernels of each build (stream_collide_kernel.cpp).
template <class T>
using CollideRows = void (*)(Block<T>&, Parity, const CollisionRates<T>&, RowRange, const WatchedPlanes&);
template <class T>
using TakeExcess = void (*)(Block<T>&, Parity);
SILT_BUILDS(template <class T> CollideRows<T> collide_rows(const CollisionRates<T>&);
            template <class T> TakeExcess<T> excess_kernel();)

/// Collides rows of a block at `parity`. When all rows are done the block is at the flipped parity, and its
/// row ends have been moved (block.hpp).
template <class T>
void stream_collide(Block<T>& block, Parity parity, const CollisionRates<T>& rates, RowRange range,
                    const WatchedPlanes& watched) {
  const auto kernel_of = SILT_CHOSEN(collide_rows<T>);
  kernel_of(rates)(block, parity, rates, range, watched);
}

}  // namespace silt::lbm
