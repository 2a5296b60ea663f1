#pragma once
// The passes of the fluid that run on a device, an entry at a time (device/for_each.hpp): the dense pass,
// slots that move, and outlets. Each gives the bits of the vector kernels.
#include <span>
#include <vector>

#include "device/device.hpp"
#include "lbm/outlet.hpp"
#include "lbm/slot_lists.hpp"
#include "lbm/stream_collide.hpp"

namespace silt::lbm {

/// Returns when all passes are done: what they wrote may then be read on the processor.
void wait(Device);
/// A pass on a device other than `cpu`; only the first waits for its end.
template <class T>
void stream_collide(Device, Block<T>&, Parity, const CollisionRates<T>&, RowRange, const WatchedPlanes&);
/// Adds addends[k] to the values of the k-th pair, if there are any.
template <class T>
void move_slots(Device, const SlotPairs&, std::span<const T> addends, SlotArrays<const T> sources,
                SlotArrays<T> targets, bool back);
template <class T>
void return_from_outlet(Device, const ReturnFromOutlet<T>&, std::size_t cells);

#define SILT_DEVICE_PASSES                                                                          \
  void wait();                                                                                      \
                                                                                                    \
  template <class T>                                                                                \
  void stream_collide(Block<T>&, Parity, const CollisionRates<T>&, RowRange, const WatchedPlanes&); \
  template <class T>                                                                                \
  void move_slots(const SlotPairs&, std::span<const T>, SlotArrays<const T>, SlotArrays<T>, bool);  \
  template <class T>                                                                                \
  void return_from_outlet(const ReturnFromOutlet<T>&, std::size_t cells);
namespace host {
SILT_DEVICE_PASSES
}
namespace gpu {
SILT_DEVICE_PASSES
}
#undef SILT_DEVICE_PASSES

}  // namespace silt::lbm
