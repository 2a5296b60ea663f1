#pragma once
// The totals of the fluid over all ranks: mass, momentum, and the extremes that the guard checks.
#include <mpi.h>

#include <array>
#include <cstdint>
#include <limits>
#include <span>

#include "lbm/blocks/moments.hpp"
#include "parallel/collectives.hpp"
#include "rigid/math/exact_sum.hpp"

namespace silt::lbm {
template <class T>
class Fluid;
template <class T>
class Temperature;
}  // namespace silt::lbm

namespace silt::coupler {

struct BlockMap;

/// Totals over the fluid cells of all ranks and levels in units of the finest lattice; a coarse cell counts
/// as the finest cells that fill it. Sums are in fixed point, so they do not depend on the number of ranks.
struct FlowTotals {
  std::uint64_t fluid_cells = 0;
  /// The forces on all cells in their steps, as a number of forces on a finest cell in its step.
  std::uint64_t forces = 0;
  double mass_deviation = 0;         // sum of density deviations
  double density_deviation = 0;      // their root mean square
  std::array<double, 3> momentum{};  // sum of c g (no half force)
  double energy = 0;                 // kinetic, of density 1
  double max_speed = 0, min_density = 0, max_density = 0;
  double min_temperature = 0, max_temperature = 0;  // as in lbm::CellTotals
  bool finite = true;  // false: some value is not a number (global cell in bad_cell)
  // global, of the finest lattice; the first of equal ones
  lbm::Int3 bad_cell{}, fastest_cell{}, thinnest_cell{}, coldest_cell{}, hottest_cell{};
};

/// Sums over cells. Each cell is rounded once to whole quanta (lbm::CellTotals). The sums have 128 bits,
/// since 64 would overflow at 2^23 lattice units, the momentum of 300^3 cells.
class FlowSums {
 public:
  /// `cells` is the size of the domain in cells of the level.
  explicit FlowSums(lbm::Int3 cells, int level = 0) : cells_(cells), level_(level) {}
  void add(lbm::Int3 global_cell, const lbm::Moments&, const std::array<double, 3>& velocity);
  /// Adds cells with sound totals. Call see() for the places of cells with extremes.
  void add(int cells, const lbm::CellTotals&);
  void see(lbm::Int3 global_cell, const lbm::CellTotals& of_the_cell);
  /// Adds the sums of another level of the same domain.
  void add(const FlowSums&);
  /// Returns this rank's momentum in CellTotals::momentum_quantum, and its fluid volume in finest cells.
  std::array<parallel::WideSum, 3> momentum() const { return {momentum_[0], momentum_[1], momentum_[2]}; }
  std::uint64_t cells() const { return count_; }
  FlowTotals over_ranks(MPI_Comm) const;  // collective

 private:
  static constexpr std::int64_t none = std::numeric_limits<std::int64_t>::max();
  static constexpr double lowest = -std::numeric_limits<double>::max();
  /// A maximum, and the first global cell that has it, by its index in the finest lattice.
  struct Extreme {
    double value;
    std::int64_t cell = none;
    void see(double x, std::int64_t index) {
      if (x < value || (x == value && index >= cell)) return;
      value = x, cell = index;
    }
    void over_ranks(MPI_Comm);
  };
  std::int64_t index_of(lbm::Int3 cell) const {
    return ((((std::int64_t(cell.z) * cells_.y << level_) + cell.y) * cells_.x << level_) + cell.x) << level_;
  }
  lbm::Int3 cell_at(std::int64_t index) const;

  lbm::Int3 cells_;
  int level_;
  std::uint64_t count_ = 0, forces_ = 0;
  rigid::FixedSum mass_ = 0, mass_square_ = 0, momentum_[3] = {}, energy_ = 0, energy_rest_ = 0;
  // of the square of the speed; deficit and excess of the density, and of the temperature
  Extreme speed_squared_{-1}, deficit_{lowest}, cold_{lowest}, heat_{lowest};
  double max_excess_ = lowest;
  std::int64_t first_bad_ = none;  // index of a global cell
};

/// Returns the sums over this rank's fluid cells, each in the precision of its populations.
template <class T>
FlowSums flow_sums(const lbm::Fluid<T>&, std::span<const BlockMap>);

}  // namespace silt::coupler
