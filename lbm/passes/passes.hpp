#pragma once
// The passes of the fluid, as built for each device: dense pass, moving slots, outlets, borders between
// levels, single cells and totals. All builds give the same bits.
#include <span>

#include "device/device.hpp"
#include "lbm/blocks/moments.hpp"
#include "lbm/collision/stream_collide.hpp"
#include "lbm/passes/fast_list.hpp"
#include "lbm/passes/level_border_rows.hpp"
#include "lbm/passes/outlet.hpp"
#include "lbm/passes/slot_lists.hpp"

namespace silt::lbm {

/// Single cells of a fluid: the block of each, and its `data` plus the offset of the cell. Per block: where
/// the populations arriving at a cell are, the steps along c_i, and the excess of the cell at `data`.
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

/// Most passes return before they are done on a device other than `cpu`.
template <class T>
struct Passes {
  /// Collides and streams the rows of block b. Examines every WatchedPlanes::period-th plane from
  /// `first_watched` on, and adds fast cells to the list.
  void (*stream_collide)(int b, Block<T>&, Parity, const CollisionRates<T>&, RowRange, int first_watched,
                         const FastList&);
  /// Returns when all passes are done and the CPU may read the results.
  void (*wait)();
  /// Copies slots; adds addends[k] to the values of the k-th pair if there are addends.
  void (*move_slots)(const SlotPairs&, std::span<const T> addends, SlotArrays<const T> sources,
                     SlotArrays<T> targets, bool back);
  void (*return_from_outlet)(const OutletCells<T>&, const SideCondition&);
  /// The two halves of the exchange at a border between levels: after a coarse pass, and after a fine pass.
  void (*carry_packets)(const BorderRows<T>&, std::span<const typename BorderRows<T>::Carried>);
  void (*cross_border)(const BorderRows<T>&, const BorderLists<T>&,
                       std::span<const typename BorderRows<T>::Passing>);
  /// Writes the moments of single cells, or only their density deviations; the other pointer is null.
  void (*gather_moments)(const ListedCells<T>&, Moments*, double* densities);
  /// Adds masses (quanta) to single cells, which may be listed repeatedly.
  void (*give_masses)(const ListedCells<T>&, const std::int64_t*);
  /// Subtracts the excess of all cells of a block from their populations, as a collision does.
  void (*take_excess)(Block<T>&, Parity);
  /// Computes the totals of rows of a block.
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
