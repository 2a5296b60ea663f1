#pragma once
// What the fluid of all ranks holds: mass, momentum, and the extremes that the guard judges.
#include <mpi.h>

#include <array>
#include <cstdint>
#include <limits>
#include <span>

#include "lbm/lattice.hpp"
#include "rigid/math/fixed_point.hpp"

namespace silt::lbm {
template <class T>
class Fluid;
struct Moments;
}  // namespace silt::lbm

namespace silt::coupler {

struct BlockMap;

/// Over the fluid cells of all ranks; lattice units. Sums are in fixed point, so they are the same on any
/// number of ranks.
struct FlowTotals {
  std::uint64_t fluid_cells = 0;
  double mass_deviation = 0;         // sum of density deviations
  std::array<double, 3> momentum{};  // sum of c g (no half force)
  double max_speed = 0, min_density = 0, max_density = 0;
  bool finite = true;  // false: some value is not a number (global cell in bad_cell)
  // global; of several the first
  lbm::Int3 bad_cell{}, fastest_cell{}, thinnest_cell{};
};

/// Adds up cells. A cell is rounded once to lbm::mass_quantum (2^-40); the sums have 128 bits, where 64 would
/// end at 2^23 lattice units, the momentum of 300^3 cells.
class FlowSums {
 public:
  /// `cells` are those of the domain.
  explicit FlowSums(lbm::Int3 cells) : cells_(cells) {}
  void add(lbm::Int3 global_cell, const lbm::Moments&, const std::array<double, 3>& velocity);
  /// Collective.
  FlowTotals over_ranks(MPI_Comm) const;
  /// Of what has been added here: the cells, and the mass in quanta.
  std::uint64_t count() const { return count_; }
  rigid::FixedSum mass() const { return sums_[0]; }

 private:
  static constexpr std::int64_t none = std::numeric_limits<std::int64_t>::max();
  static constexpr double lowest = -std::numeric_limits<double>::max();
  /// The largest of something and the first global cell, by its index, that has it.
  struct Extreme {
    double value;
    std::int64_t cell = none;
    void see(double x, std::int64_t index) {
      if (x < value || (x == value && index >= cell)) return;
      value = x, cell = index;
    }
    void over_ranks(MPI_Comm);
  };
  lbm::Int3 cell_at(std::int64_t index) const;

  lbm::Int3 cells_;
  std::uint64_t count_ = 0;
  rigid::FixedSum sums_[4] = {};         // mass, momentum
  Extreme speed_{-1}, deficit_{lowest};  // deficit and excess of the density
  double max_excess_ = lowest;
  std::int64_t first_bad_ = none;  // index of a global cell
};

/// Adds up the fluid cells of this rank.
template <class T>
FlowSums flow_sums(const lbm::Fluid<T>&, std::span<const BlockMap>);
/// Collective.
template <class T>
FlowTotals flow_totals(const lbm::Fluid<T>&, std::span<const BlockMap>);

}  // namespace silt::coupler
