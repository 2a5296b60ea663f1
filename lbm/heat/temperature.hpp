#pragma once
// The temperature of a fluid: a scalar on D3Q7 in the same blocks and steps, carried by its passes
// (method-heat.md). The populations are deviations from the reference temperature.
#include <array>
#include <vector>

#include "lbm/collision/heat_rates.hpp"
#include "lbm/exchange/halo.hpp"
#include "lbm/fluid.hpp"

namespace silt::lbm {

/// Returns the condition of the temperature at a side: insulating, or letting this heat into the fluid per
/// area and step.
SideCondition heat_side(int side, double flux = 0);

template <class T>
class Temperature final : public Carried {
 public:
  using Number = T;
  using Lattice = D3Q7;
  /// Starts at the reference temperature. `sides` are periodic where those of the fluid are; of the kinds
  /// bounce (heat_side), free_slip, temperature or open elsewhere. The fluid carries it from now on, and
  /// feels its buoyancy. Throws std::invalid_argument for a diffusivity that is not above 0.
  Temperature(Fluid<T>&, const HeatSpec&, const std::array<SideCondition, 6>& sides);
  Temperature(const Temperature&) = delete;

  const Domain& domain() const { return domain_; }
  const HeatSpec& spec() const { return spec_; }
  std::vector<Block<T, D3Q7>>& blocks() { return blocks_; }
  const std::vector<Block<T, D3Q7>>& blocks() const { return blocks_; }
  const Fluid<T>& fluid() const { return fluid_; }
  /// As of the fluid, for borders between levels.
  Parity parity() const { return fluid_.parity(); }
  std::int64_t passes() const { return fluid_.passes(); }
  MPI_Comm comm() const { return fluid_.comm(); }
  Device device() const { return fluid_.device(); }
  bool is_in_parts() const { return fluid_.is_in_parts(); }
  const PassOrder& pass_order(int b) const { return fluid_.pass_order(b); }
  double half_push(int) const { return 0; }

  void start_exchange(Parity parity) override { halo_.start(parity); }
  /// Cut links come after it. Blocks without fluid cells receive what comes to them, too: cells that bodies
  /// uncover in them begin with it.
  void exchange() override { halo_.exchange(blocks_, none_idle_, parity()); }

  T& arriving(int b, Int3 cell, int i) {
    return blocks_[b].data()[blocks_[b].arriving(i, parity()) + blocks_[b].cell(cell)];
  }
  T arriving(int b, Int3 cell, int i) const { return const_cast<Temperature*>(this)->arriving(b, cell, i); }
  /// Returns the population that left a cell along i in the last pass; valid until the next one.
  T leaving(int b, Int3 cell, int i) const {
    return blocks_[b].data()[blocks_[b].leaving(i, parity()) + blocks_[b].cell(cell)];
  }
  /// Returns the temperature of a cell, less the reference temperature.
  double at(int b, Int3 cell) const;
  /// Sets a cell to the equilibrium (H1) of a fluid of this velocity.
  void set(int b, Int3 cell, double temperature, const std::array<double, 3>& velocity);
  /// Returns the size of the arrays of populations.
  std::size_t bytes() const;

 private:
  const Fluid<T>& fluid_;
  Domain domain_;
  HeatSpec spec_;
  std::vector<Block<T, D3Q7>> blocks_;
  std::vector<char> none_idle_;
  Halo<T, D3Q7> halo_;
};

}  // namespace silt::lbm
