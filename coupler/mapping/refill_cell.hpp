#pragma once
// The pass that sets the populations of cells that a body has left.
#include <array>
#include <cstdint>

#include "cpu/prefetch.hpp"
#include "lbm/blocks/moments.hpp"
#include "lbm/passes/passes.hpp"

namespace silt::coupler {

/// An uncovered cell: its neighbours that were and are fluid, as bits by direction, and those in other
/// blocks, whose moments are at places (MomentsElsewhere) from first_place on.
struct UncoveredCell {
  std::uint32_t neighbours = 0, elsewhere = 0, first_place = 0;
  double momentum[3] = {};  // of the surface there, less half the force
};

/// The moments of neighbours in other blocks: of this rank, computed by a pass; of other ranks, as they told.
struct MomentsElsewhere {
  const std::uint32_t* places;  // 2 n: the n-th that was told; 2 n + 1: the n-th of this rank
  const lbm::Moments *told, *near;
  SILT_DEVICE const lbm::Moments& operator[](std::uint32_t k) const {
    const std::uint32_t place = places[k];
    return (place & 1 ? near : told)[place >> 1];
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
  lbm::ListedCells<T> listed;
  const UncoveredCell* uncovered;
  MomentsElsewhere elsewhere;
  std::array<double, 3> force;

  static constexpr int ahead = 2;
  void fetch(std::int64_t k) const {
    const auto& block = listed.block_of(k);
    for (const std::ptrdiff_t step : block.step)
      for (const std::ptrdiff_t arriving : block.arriving) prefetch_to_read(listed.data(k) + step + arriving);
  }
  SILT_DEVICE void operator()(std::int64_t k) const {
    const auto& block = listed.block_of(k);
    const UncoveredCell& cell = uncovered[k];
    T* const data = listed.data(k);
    const T* g[lbm::D3Q19::directions];
    for (int i = 0; i < lbm::D3Q19::directions; ++i) g[i] = data + block.arriving[i];
    lbm::ExcessQuanta<T>* const excess = listed.excess(k);
    const auto moments_at = [&](std::ptrdiff_t step) {
      return excess ? lbm::moments_of<T>(g, step, excess[step], block.stress_share)
                    : lbm::moments_of<T>(g, step);
    };
    std::uint32_t next = cell.first_place;
    NeighbourMeans means;
    for (int i = 1; i < lbm::D3Q19::directions; ++i)
      if (cell.neighbours >> i & 1)
        means.add(cell.elsewhere >> i & 1 ? elsewhere[next++] : moments_at(block.step[i]), force);
    means.finish();
    lbm::for_directions<lbm::D3Q19, 0>([&](auto i) {
      constexpr lbm::Int3 c = lbm::D3Q19::c[i()];
      const double arriving = lbm::equilibrium(c, lbm::D3Q19::w(i()), means.density, cell.momentum) +
                              means.grad_part(c, lbm::D3Q19::w(i()));
      data[block.arriving[i()]] = T(arriving);
    });
    if (excess) *excess = 0;
  }
};

/// Cells that pass their mass on to neighbours in their block that were and are fluid, as bits by direction.
/// The first `covered` of them give it away, the others take it.
template <class T>
struct PassingCells {
  lbm::ListedCells<T> listed;
  std::int64_t covered;
  const std::uint32_t* neighbours;
  std::int64_t *masses, *left;  // in quanta of lbm/blocks/excess.hpp; `left`: of cells without a neighbour
};

SILT_DEVICES(template <class T> void refill_cells(const RefillCells<T>&);
             template <class T> void weigh_cells(const PassingCells<T>&);
             template <class T> void share_masses(const PassingCells<T>&);)

}  // namespace silt::coupler
