#pragma once
// The passes of the fluid that run on a device, an entry at a time (device/for_each.hpp): the dense pass,
// slots that move, and outlets. Each gives the bits of the vector kernels.
#include <span>
#include <vector>

#include "device/device.hpp"
#include "lbm/level_border_rows.hpp"
#include "lbm/moments.hpp"
#include "lbm/outlet.hpp"
#include "lbm/slot_lists.hpp"
#include "lbm/stream_collide.hpp"

namespace silt::lbm {

/// Single cells of the blocks of a fluid: where a cell's populations are counted from, and its block; for
/// each block, where those arriving at a cell are, and how far the next cell along c_i is.
template <class T>
struct ListedCells {
  struct Cell {
    T* data;
    int block;
  };
  struct Block {
    std::ptrdiff_t arriving[directions], step[directions];
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

/// Returns when all passes are done: what they wrote may then be read on the processor.
void wait(Device);
/// A pass on a device other than `cpu`; most do not wait for its end. This one looks at every
/// WatchedPlanes::period-th plane from one on, and take_fast_cells() waits for what it has found in block b
/// since it was called last, by block and cell.
template <class T>
void stream_collide(Device, int b, Block<T>&, Parity, const CollisionRates<T>&, RowRange, int first_watched);
std::vector<FastInBlock> take_fast_cells(Device);
/// Adds addends[k] to the values of the k-th pair, if there are any.
template <class T>
void move_slots(Device, const SlotPairs&, std::span<const T> addends, SlotArrays<const T> sources,
                SlotArrays<T> targets, bool back);
template <class T>
void return_from_outlet(Device, const ReturnFromOutlet<T>&, std::size_t cells);
/// What is done at a border when its coarse cells have collided, and after a pass of its fine ones.
template <class T>
void carry_packets(Device, const BorderRows<T>&, std::span<const typename BorderRows<T>::Carried>);
template <class T>
void cross_border(Device, const BorderRows<T>&, const BorderLists<T>&,
                  std::span<const typename BorderRows<T>::Passing>);

/// The moments of single cells, or their density deviations alone; the other pointer is null.
template <class T>
void gather_moments(Device, const ListedCells<T>&, Moments*, double* densities);
/// The totals and the masses of rows of cells of a block.
template <class T>
void total_rows(Device, const Block<T>&, Parity, std::span<const LocalRows>,
                const std::array<double, 3>& force, CellTotals*);
template <class T>
void mass_of_rows(Device, const Block<T>&, Parity, std::span<const LocalRows>, std::int64_t* quanta);

#define SILT_DEVICE_PASSES                                                                           \
  std::vector<FastInBlock> take_fast_cells();                                                        \
  void wait();                                                                                       \
                                                                                                     \
  template <class T>                                                                                 \
  void stream_collide(int, Block<T>&, Parity, const CollisionRates<T>&, RowRange, int);              \
  template <class T>                                                                                 \
  void move_slots(const SlotPairs&, std::span<const T>, SlotArrays<const T>, SlotArrays<T>, bool);   \
  template <class T>                                                                                 \
  void return_from_outlet(const ReturnFromOutlet<T>&, std::size_t cells);                            \
  template <class T>                                                                                 \
  void gather_moments(const ListedCells<T>&, Moments*, double* densities);                           \
  template <class T>                                                                                 \
  void total_rows(const Block<T>&, Parity, std::span<const LocalRows>, const std::array<double, 3>&, \
                  CellTotals*);                                                                      \
  template <class T>                                                                                 \
  void carry_packets(const BorderRows<T>&, std::span<const typename BorderRows<T>::Carried>);        \
  template <class T>                                                                                 \
  void cross_border(const BorderRows<T>&, const BorderLists<T>&,                                     \
                    std::span<const typename BorderRows<T>::Passing>);                               \
  template <class T>                                                                                 \
  void mass_of_rows(const Block<T>&, Parity, std::span<const LocalRows>, std::int64_t* quanta);
namespace host {
SILT_DEVICE_PASSES
}
namespace gpu {
SILT_DEVICE_PASSES
}
#undef SILT_DEVICE_PASSES

}  // namespace silt::lbm
