#pragma once
// Passes over cells that turned solid or fluid: the populations of those that a body has left, and the mass
// that they pass on.
#include <array>
#include <cstdint>

#include "cpu/prefetch.hpp"
#include "lbm/blocks/moments.hpp"
#include "lbm/passes/passes.hpp"

namespace silt::coupler {

/// A cell that turned solid or fluid: its offset in the block, and its neighbours that were and are fluid, as
/// bits by direction.
struct ChangedCell {
  static constexpr std::uint32_t at_face = 1;  // in `neighbours`: one of them is in another block
  std::uint32_t offset, neighbours;
};

/// Such cells of one block.
template <class T>
struct ChangedInBlock {
  typename lbm::ListedCells<T>::Block block;
  const ChangedCell* cells;
  std::int64_t count;
};

/// Neighbours in other blocks of a changed cell, as bits by direction; they are at places (CellsAtFaces) from
/// first_place on.
struct FaceCell {
  std::uint32_t cell, neighbours, first_place;
};

/// The changed cells with neighbours in other blocks.
struct CellsAtFaces {
  const FaceCell* cells;  // in the order of `cell`
  std::int64_t count;
  const std::uint32_t* places;  // 2 n: the n-th neighbour on other ranks; 2 n + 1: the n-th on this one

  /// Returns a cell by its number, or one without such neighbours.
  SILT_DEVICE const FaceCell& of(std::uint32_t cell) const {
    std::int64_t first = 0, end = count;
    while (end - first > 1) {
      const std::int64_t middle = (first + end) / 2;
      (cells[middle].cell <= cell ? first : end) = middle;
    }
    return cells[first];
  }
};

/// The moments of neighbours in other blocks: of this rank, computed by a pass; of other ranks, as they told.
struct MomentsElsewhere {
  const lbm::Moments *told, *near;
  SILT_DEVICE const lbm::Moments& operator[](std::uint32_t place) const {
    // Two statements: g++ 12 errs in (place & 1 ? near : told)[place >> 1] under -fsanitize=shift.
    const lbm::Moments* const all = place & 1 ? near : told;
    return all[place >> 1];
  }
};

/// Means over neighbours of the density and of the flux of momentum off equilibrium, sum c c (g - g_eq).
class NeighbourMeans {
 public:
  double density = 0, stress[6] = {};

  SILT_DEVICE void add(const lbm::Moments& m, const std::array<double, 3>& force) {
    ++count_;
    const double rho = m.density_deviation;
    density += rho;
    const std::array<double, 3> u = lbm::velocity_of(m, force);
    const double eq[6] = {rho / 3 + u[0] * u[0], rho / 3 + u[1] * u[1], rho / 3 + u[2] * u[2],
                          u[0] * u[1],           u[0] * u[2],           u[1] * u[2]};
    for (int k = 0; k < 6; ++k) stress[k] += m.flux[k] - eq[k];
  }
  SILT_DEVICE void finish() {
    if (count_ == 0) return;
    density /= count_;
    for (double& s : stress) s /= count_;
  }
  SILT_DEVICE double grad_part(lbm::Int3 c, double weight) const {
    const double* const s = stress;
    const double css = c.x * c.x * s[0] + c.y * c.y * s[1] + c.z * c.z * s[2] +
                       2 * (c.x * c.y * s[3] + c.x * c.z * s[4] + c.y * c.z * s[5]);
    return 4.5 * weight * (css - (s[0] + s[1] + s[2]) / 3);
  }

 private:
  int count_ = 0;
};

/// Sets the populations that arrive at uncovered cells; no uncovered cell is read for another.
template <class T>
struct RefillCells {
  ChangedInBlock<T> of;
  std::uint32_t first;                   // number of the first of them among all
  const std::array<double, 3>* momenta;  // of the surface at each of all, less half the force
  CellsAtFaces faces;
  MomentsElsewhere elsewhere;
  std::array<double, 3> force;

  static constexpr int ahead = 2;
  void fetch(std::int64_t k) const {
    for (const std::ptrdiff_t step : of.block.step)
      for (const std::ptrdiff_t arriving : of.block.arriving)
        prefetch_to_read(of.block.data + of.cells[k].offset + step + arriving);
  }
  SILT_DEVICE NeighbourMeans means_around(std::int64_t k) const {
    const auto& [offset, neighbours] = of.cells[k];
    const auto cell = first + std::uint32_t(k);
    const FaceCell face = neighbours & ChangedCell::at_face ? faces.of(cell) : FaceCell{};
    std::uint32_t next = face.first_place;
    NeighbourMeans means;
    for (int i = 1; i < lbm::D3Q19::directions; ++i)
      if (face.neighbours >> i & 1)
        means.add(elsewhere[faces.places[next++]], force);
      else if (neighbours >> i & 1)
        means.add(of.block.moments_at(offset + std::uint32_t(of.block.step[i])), force);
    means.finish();
    return means;
  }
  SILT_DEVICE void operator()(std::int64_t k) const {
    T* const data = of.block.data + of.cells[k].offset;
    double momentum[3];
    for (int d = 0; d < 3; ++d) momentum[d] = momenta[first + k][std::size_t(d)];
    const NeighbourMeans means = means_around(k);
    lbm::for_directions<lbm::D3Q19, 0>([&](auto i) {
      constexpr lbm::Int3 c = lbm::D3Q19::c[i()];
      const double arriving = lbm::equilibrium(c, lbm::D3Q19::w(i()), means.density, momentum) +
                              means.grad_part(c, lbm::D3Q19::w(i()));
      data[of.block.arriving[i()]] = T(arriving);
    });
    if (of.block.excess) of.block.excess[of.cells[k].offset] = 0;
  }
};

/// Cells that pass their mass on to their neighbours that were and are fluid: covered cells give it away,
/// uncovered ones take it.
template <class T>
struct PassingCells {
  ChangedInBlock<T> of;
  int sign;              // -1: they take it
  std::uint32_t first;   // number of the first of them among all
  std::int64_t* masses;  // of all; this and the next two in quanta of lbm/blocks/excess.hpp
  std::int64_t* left;    // of all cells without a neighbour
  std::int64_t* sent;    // to neighbours on other ranks; null: they have it
  CellsAtFaces faces;
  lbm::ListedCells<T> near;  // neighbours in other blocks of this rank
};

SILT_DEVICES(template <class T> void refill_cells(const RefillCells<T>&);
             template <class T> void weigh_cells(const PassingCells<T>&);
             template <class T> void share_masses(const PassingCells<T>&);)

}  // namespace silt::coupler
