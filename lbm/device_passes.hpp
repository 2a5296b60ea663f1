#pragma once
// The passes of the fluid that run on a device, an entry at a time (device/for_each.hpp): the dense pass,
// slots that move on this rank, and outlets. Each gives the bits of the vector kernels.
#include <span>
#include <vector>

#include "device/device.hpp"
#include "lbm/outlet.hpp"
#include "lbm/stream_collide.hpp"

namespace silt::lbm {

/// A slot's value goes to another slot: `home` to `ghost`, or back.
template <class T>
struct SlotMove {
  T *home, *ghost;
  T addend;  // of a wall; a plain copy has none
  bool is_plain;
};

/// Runs a pass on a device other than `cpu`.
template <class T>
void stream_collide(Device, Block<T>&, Parity, const CollisionRates<T>&, RowRange, const WatchedPlanes&);
template <class T>
void move_slots(Device, std::span<const SlotMove<T>>, bool back);
template <class T>
void return_from_outlet(Device, const ReturnFromOutlet<T>&, std::size_t cells);

#define SILT_DEVICE_PASSES                                                                          \
  template <class T>                                                                                \
  void stream_collide(Block<T>&, Parity, const CollisionRates<T>&, RowRange, const WatchedPlanes&); \
  template <class T>                                                                                \
  void move_slots(std::span<const SlotMove<T>>, bool back);                                         \
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
