#pragma once
// The passes of the fluid, as the build for each device has them: the dense pass, slots that move, outlets,
// borders between levels, single cells and totals. All builds give the same bits.
#include <span>
#include <vector>

#include "device/device.hpp"
#include "lbm/blocks/moments.hpp"
#include "lbm/collision/stream_collide.hpp"
#include "lbm/passes/level_border_rows.hpp"
#include "lbm/passes/outlet.hpp"
#include "lbm/passes/slot_lists.hpp"

namespace silt::lbm {

/// Single cells of the blocks of a fluid: where a cell's populations are counted from, and its block; for
/// each block, where those arriving at a cell are, how far the next cell along c_i is, and the excess of cell
/// 0, whose populations are counted from `data`.
template <class T>
struct ListedCells {
  struct Cell {
    T* data;
    int block;
  };
  struct Block {
    std::ptrdiff_t arriving[D3Q19::directions], step[D3Q19::directions];
    T* data;
    ExcessQuanta<T>* excess;
    T stress_share;
  };
  const Cell* cells;
  std::int64_t count;
  const Block* blocks;
};

/// A fast cell of a block of a fluid.
struct FastInBlock {
  int block;
  FastCell at;
};

/// Most passes of a device other than `cpu` return before they are done.
template <class T>
struct Passes {
  /// Collides and streams the rows of block b. Examines every WatchedPlanes::period-th plane from
  /// `first_watched` on.
  void (*stream_collide)(int b, Block<T>&, Parity, const CollisionRates<T>&, RowRange, int first_watched);
  /// Returns the fast cells found since the last call, in any order, once all passes are done.
  std::vector<FastInBlock> (*take_fast_cells)();
  /// Returns when all passes are done: the processor may then read what they wrote.
  void (*wait)();
  /// Moves slots and adds addends[k] to the values of the k-th pair, if there are any.
  void (*move_slots)(const SlotPairs&, std::span<const T> addends, SlotArrays<const T> sources,
                     SlotArrays<T> targets, bool back);
  void (*return_from_outlet)(const OutletCells<T>&, const SideCondition&);
  /// Serves a border between levels: after its coarse cells have collided, and after a pass of its fine ones.
  void (*carry_packets)(const BorderRows<T>&, std::span<const typename BorderRows<T>::Carried>);
  void (*cross_border)(const BorderRows<T>&, const BorderLists<T>&,
                       std::span<const typename BorderRows<T>::Passing>);
  /// Gathers the moments of single cells, or their density deviations alone; the other pointer is null.
  void (*gather_moments)(const ListedCells<T>&, Moments*, double* densities);
  /// Gives single cells these masses (quanta), of which a cell may get several.
  void (*give_masses)(const ListedCells<T>&, const std::int64_t*);
  /// All cells of a block give up their excess, as they do when they collide.
  void (*take_excess)(Block<T>&, Parity);
  /// Sums up the cells of rows of a block.
  void (*total_rows)(const Block<T>&, Parity, std::span<const LocalRows>, const std::array<double, 3>& force,
                     CellTotals*);
};
SILT_DEVICES(template <class T> const Passes<T>& passes();)
template <class T>
const Passes<T>& passes_on(Device device) {
  return SILT_ON(device, passes<T>)();
}

inline void wait(Device device) {
  passes_on<float>(device).wait();
}

}  // namespace silt::lbm
