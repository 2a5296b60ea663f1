// The pass of refill_cell.hpp, for the one file per device that includes this (SILT_BUILD).
#include "coupler/mapping/refill_cell.hpp"
#include "device/for_each.hpp"

namespace silt::coupler::SILT_BUILD {

template <class T>
void refill_cells(const RefillCells<T>& cells) {
  for_each(cells.listed.count, cells);
  wait();
}
template void refill_cells(const RefillCells<float>&);
template void refill_cells(const RefillCells<double>&);

}  // namespace silt::coupler::SILT_BUILD
