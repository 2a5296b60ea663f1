#include "lbm/device_passes.hpp"

namespace silt::lbm {

void wait(Device device) {
  if (device != Device::cpu) SILT_ON(device, wait)();
}

std::vector<FastInBlock> take_fast_cells([[maybe_unused]] Device device) {
  std::vector<FastInBlock> found = SILT_ON(device, take_fast_cells)();
  from_device(std::uint32_t(), found);  // how many, and these
  return found;
}

template <class T>
void stream_collide([[maybe_unused]] Device device, int b, Block<T>& block, Parity parity,
                    const CollisionRates<T>& rates, RowRange range, int first_watched) {
  SILT_ON(device, stream_collide<T>)(b, block, parity, rates, range, first_watched);
}

template <class T>
void move_slots([[maybe_unused]] Device device, const SlotPairs& pairs, std::span<const T> addends,
                SlotArrays<const T> sources, SlotArrays<T> targets, bool back) {
  SILT_ON(device, move_slots<T>)(pairs, addends, sources, targets, back);
}

template <class T>
void return_from_outlet([[maybe_unused]] Device device, const ReturnFromOutlet<T>& cell, std::size_t cells) {
  SILT_ON(device, return_from_outlet<T>)(cell, cells);
}

template <class T>
void carry_packets([[maybe_unused]] Device device, const BorderRows<T>& rows,
                   std::span<const typename BorderRows<T>::Carried> carried) {
  SILT_ON(device, carry_packets<T>)(rows, carried);
}

template <class T>
void cross_border([[maybe_unused]] Device device, const BorderRows<T>& rows, const BorderLists<T>& lists,
                  std::span<const typename BorderRows<T>::Passing> passing) {
  SILT_ON(device, cross_border<T>)(rows, lists, passing);
}

template <class T>
void gather_moments([[maybe_unused]] Device device, const ListedCells<T>& cells, Moments* moments,
                    double* densities) {
  SILT_ON(device, gather_moments<T>)(cells, moments, densities);
}

template <class T>
void total_rows([[maybe_unused]] Device device, const Block<T>& block, Parity parity,
                std::span<const LocalRows> rows, const std::array<double, 3>& force, CellTotals* totals) {
  SILT_ON(device, total_rows<T>)(block, parity, rows, force, totals);
  to_device(rows), from_device(std::span(totals, rows.size()));
}

template <class T>
void mass_of_rows([[maybe_unused]] Device device, const Block<T>& block, Parity parity,
                  std::span<const LocalRows> rows, std::int64_t* quanta) {
  SILT_ON(device, mass_of_rows<T>)(block, parity, rows, quanta);
  to_device(rows), from_device(std::span(quanta, rows.size()));
}

#define SILT_PASSES_OF(T)                                                                                    \
  template void stream_collide(Device, int, Block<T>&, Parity, const CollisionRates<T>&, RowRange, int);     \
  template void move_slots(Device, const SlotPairs&, std::span<const T>, SlotArrays<const T>, SlotArrays<T>, \
                           bool);                                                                            \
  template void return_from_outlet(Device, const ReturnFromOutlet<T>&, std::size_t);                         \
  template void gather_moments(Device, const ListedCells<T>&, Moments*, double*);                            \
  template void carry_packets(Device, const BorderRows<T>&, std::span<const BorderRows<T>::Carried>);        \
  template void cross_border(Device, const BorderRows<T>&, const BorderLists<T>&,                            \
                             std::span<const BorderRows<T>::Passing>);                                       \
  template void total_rows(Device, const Block<T>&, Parity, std::span<const LocalRows>,                      \
                           const std::array<double, 3>&, CellTotals*);                                       \
  template void mass_of_rows(Device, const Block<T>&, Parity, std::span<const LocalRows>, std::int64_t*);
SILT_PASSES_OF(float)
SILT_PASSES_OF(double)

}  // namespace silt::lbm
