// The passes of refill_cell.hpp, for the one file per device that includes this (SILT_BUILD).
#include <cmath>
#include <cstdint>

#include "coupler/mapping/refill_cell.hpp"
#include "device/for_each.hpp"

namespace silt::coupler::SILT_BUILD {

template <class T>
void refill_cells(const RefillCells<T>& cells) {
  for_each(cells.of.count, cells);
}
template void refill_cells(const RefillCells<float>&);
template void refill_cells(const RefillCells<double>&);

template <class T>
struct WeighCells {
  PassingCells<T> all;
  SILT_DEVICE void operator()(std::int64_t k) const {
    const auto& [offset, neighbours] = all.of.cells[k];
    all.masses[k] = 0;
    if (neighbours & ChangedCell::at_face) return;
    all.masses[k] =
        all.sign * std::llrint(all.of.block.moments_at(offset).density_deviation / lbm::excess_quantum<T>);
    if (neighbours == 0) add_to(*all.left, all.masses[k]);
  }
};

/// Divides the mass of a cell evenly, but for the last quanta.
template <class T>
struct ShareMasses {
  PassingCells<T> all;
  SILT_DEVICE void operator()(std::int64_t k) const {
    const auto& [offset, neighbours] = all.of.cells[k];
    if (neighbours & ChangedCell::at_face) return;
    std::int64_t mass = all.masses[k];
    int shares = bits_in(neighbours);
    for (std::uint32_t left = neighbours; left; left &= left - 1, --shares) {
      const std::int64_t part = mass / shares;
      mass -= part;
      add_to(all.of.block.excess[offset + all.of.block.step[lowest_bit(left)]], lbm::ExcessQuanta<T>(-part));
    }
  }
};

template <class T>
void weigh_cells(const PassingCells<T>& cells) {
  for_each(cells.of.count, WeighCells<T>{cells});
}
template <class T>
void share_masses(const PassingCells<T>& cells) {
  for_each(cells.of.count, ShareMasses<T>{cells});
}
template void weigh_cells(const PassingCells<float>&);
template void weigh_cells(const PassingCells<double>&);
template void share_masses(const PassingCells<float>&);
template void share_masses(const PassingCells<double>&);

}  // namespace silt::coupler::SILT_BUILD
