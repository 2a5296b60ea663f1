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

/// The mass of a cell, divided evenly among its neighbours but for the last quanta.
template <class T>
class SharedMass {
 public:
  SILT_DEVICE SharedMass(const PassingCells<T>& all, std::int64_t k)
      : all_(all), k_(k), neighbours_(all.of.cells[k].neighbours & ~ChangedCell::at_face) {}

  /// Gives their parts to neighbours on this rank.
  SILT_DEVICE void give() const {
    const std::uint32_t offset = all_.of.cells[k_].offset;
    visit(
        [&](int i, std::int64_t part) {
          add_to(all_.of.block.excess[offset + all_.of.block.step[i]], lbm::ExcessQuanta<T>(-part));
        },
        [&](std::uint32_t place, std::int64_t part) {
          if (place & 1) add_to(*all_.near.excess(place >> 1), lbm::ExcessQuanta<T>(-part));
        });
  }
  /// Notes the parts of neighbours on other ranks.
  SILT_DEVICE void send() const {
    visit([](int, std::int64_t) {},
          [&](std::uint32_t place, std::int64_t part) {
            if (!(place & 1)) all_.sent[place >> 1] = part;
          });
  }

 private:
  /// Calls here(direction, part) for neighbours in the block, elsewhere(place, part) for others.
  template <class Here, class Elsewhere>
  SILT_DEVICE void visit(Here&& here, Elsewhere&& elsewhere) const {
    const auto cell = all_.first + std::uint32_t(k_);
    const bool at_face = all_.of.cells[k_].neighbours & ChangedCell::at_face;
    const FaceCell face = at_face ? all_.faces.of(cell) : FaceCell{};
    std::uint32_t next = face.first_place;
    std::int64_t mass = all_.masses[cell];
    int shares = bits_in(neighbours_);
    for (std::uint32_t left = neighbours_; left; left &= left - 1, --shares) {
      const int i = lowest_bit(left);
      const std::int64_t part = mass / shares;
      mass -= part;
      if (face.neighbours >> i & 1)
        elsewhere(all_.faces.places[next++], part);
      else
        here(i, part);
    }
  }

  const PassingCells<T>& all_;
  std::int64_t k_;
  std::uint32_t neighbours_;
};

template <class T>
struct WeighCells {
  PassingCells<T> all;
  SILT_DEVICE void operator()(std::int64_t k) const {
    const auto& [offset, neighbours] = all.of.cells[k];
    const std::int64_t mass =
        all.sign * std::llrint(all.of.block.moments_at(offset).density_deviation / lbm::excess_quantum<T>);
    all.masses[all.first + k] = mass;
    if (neighbours == 0) add_to(*all.left, mass);
    if (all.sent && neighbours & ChangedCell::at_face) SharedMass<T>(all, k).send();
  }
};

template <class T>
struct ShareMasses {
  PassingCells<T> all;
  SILT_DEVICE void operator()(std::int64_t k) const { SharedMass<T>(all, k).give(); }
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
