#pragma once
// The passes of the fluid, as built for each device: dense pass, moving slots, outlets, borders between
// levels, single cells and totals. All builds give the same bits.
#include <span>
#include <vector>

#include "device/device.hpp"
#include "device/mirror.hpp"
#include "lbm/blocks/moments.hpp"
#include "lbm/collision/stream_collide.hpp"
#include "lbm/passes/level_border_patches.hpp"
#include "lbm/passes/outlet.hpp"
#include "lbm/passes/slot_lists.hpp"

namespace silt::lbm {

/// A fast cell of a block of a fluid.
struct FastInBlock {
  int block;
  FastCell at;
};

/// Fast cells in any order, as passes see them; beyond `room` they are only counted.
struct FastList {
  static constexpr unsigned room = 4096;
  FastInBlock* cells;
  unsigned* count;
};
FastList fast_list(Device);
/// What a pass over a block watches: every WatchedPlanes::period-th plane from one on.
struct FastWatch {
  FastList list;
  int block, first_plane;
};
/// Returns the fast cells found since the last call, in any order; waits for all passes.
std::vector<FastInBlock> take_fast_cells(Device);

/// Single cells of a fluid: the block of each, and its offset there (Block::cell). Per block: where the
/// populations arriving at a cell are, the steps along c_i, and the excess of the cell at `data`.
template <class T>
struct ListedCells {
  struct Cell {
    std::uint32_t offset, block;
  };
  struct Block {
    std::ptrdiff_t arriving[D3Q19::directions], step[D3Q19::directions];
    T* data;
    ExcessQuanta<T>* excess;
    T stress_share;
    /// Returns the excess of a cell; null if the block has none.
    SILT_DEVICE ExcessQuanta<T>* excess_at(std::uint32_t offset) const {
      return excess ? excess + offset : nullptr;
    }
    SILT_DEVICE Moments moments_at(std::uint32_t offset) const {
      const T* g[D3Q19::directions];
      for (int i = 0; i < D3Q19::directions; ++i) g[i] = data + offset + arriving[i];
      return excess ? moments_of<T>(g, 0, excess[offset], stress_share) : moments_of<T>(g, 0);
    }
  };
  const Cell* cells;
  std::int64_t count;
  const Block* blocks;
  SILT_DEVICE const Block& block_of(std::int64_t k) const { return blocks[cells[k].block]; }
  SILT_DEVICE T* data(std::int64_t k) const { return block_of(k).data + cells[k].offset; }
  SILT_DEVICE ExcessQuanta<T>* excess(std::int64_t k) const { return block_of(k).excess_at(cells[k].offset); }
  SILT_DEVICE Moments moments(std::int64_t k) const { return block_of(k).moments_at(cells[k].offset); }
};

/// The arrays of ListedCells.
template <class T>
struct CellLists {
  Mirror<typename ListedCells<T>::Cell> cells;
  Mirror<typename ListedCells<T>::Block> blocks;
  explicit CellLists(Device device) : cells(device), blocks(device) {}
};

/// On a device other than `cpu` most passes return before they are complete.
template <class T>
struct Passes {
  /// Collides and streams rows of a block, and adds fast cells of the watched planes to the list.
  void (*stream_collide)(Block<T>&, Parity, const CollisionRates<T>&, RowRange, const FastWatch&);
  /// Returns when all passes are done and the CPU may read the results.
  void (*wait)();
  /// Copies slots; adds addends[k] to the values of the k-th pair if there are addends.
  void (*move_slots)(const SlotPairs&, std::span<const T> addends, SlotArrays<const T> sources,
                     SlotArrays<T> targets, bool back);
  void (*return_from_outlet)(const OutletCells<T>&, const SideCondition&);
  void (*return_temperature)(const OutletCells<T, D3Q7>&, const SideCondition&);
  /// The two halves of the exchange at a border between levels: after a coarse pass, and after a fine pass.
  void (*carry_packets)(const BorderPatches<T>&, std::span<const typename BorderPatches<T>::Carried>);
  void (*cross_border)(const BorderPatches<T>&, const BorderLists<T>&,
                       std::span<const typename BorderPatches<T>::Passing>);
  /// Writes the moments of single cells.
  void (*gather_moments)(const ListedCells<T>&, Moments*);
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
