#include "lbm/device_passes.hpp"

namespace silt::lbm {

template <class T>
void stream_collide(Device device, Block<T>& block, Parity parity, const CollisionRates<T>& rates,
                    RowRange range, const WatchedPlanes& watched) {
  if (device == Device::host) return host::stream_collide(block, parity, rates, range, watched);
#if defined(SILT_CUDA)
  return gpu::stream_collide(block, parity, rates, range, watched);
#endif
  __builtin_unreachable();
}

template <class T>
void move_slots(Device device, std::span<const SlotMove<T>> moves, bool back) {
  if (device == Device::host) return host::move_slots(moves, back);
#if defined(SILT_CUDA)
  return gpu::move_slots(moves, back);
#endif
  __builtin_unreachable();
}

template void stream_collide(Device, Block<float>&, Parity, const CollisionRates<float>&, RowRange,
                             const WatchedPlanes&);
template void stream_collide(Device, Block<double>&, Parity, const CollisionRates<double>&, RowRange,
                             const WatchedPlanes&);
template void move_slots(Device, std::span<const SlotMove<float>>, bool);
template void move_slots(Device, std::span<const SlotMove<double>>, bool);

}  // namespace silt::lbm
