#pragma once
// The fields of the fluid on this rank, read and written by boxes of cells, whatever the precision of its
// populations, and which cells are fluid.
#include <array>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "coupler/flow_totals.hpp"
#include "coupler/mapping/solid_map.hpp"
#include "lbm/domain.hpp"
#include "lbm/moments.hpp"

namespace silt::coupler {

struct Case;

/// The fluid cells of a rank and their mass in quanta.
struct FluidMass {
  std::uint64_t cells = 0;
  rigid::FixedSum mass = 0;
};

class FluidFields {
 public:
  virtual ~FluidFields() = default;

  const lbm::Domain& domain() const { return domain_; }
  int level() const { return 0; }  // of the lattice; 0 is the finest
  const std::vector<BlockMap>& maps() const { return maps_; }  // of this rank's blocks
  int blocks() const { return int(maps_.size()); }
  const lbm::CellBox& block(int b) const { return maps_[b].box; }  // global cells
  const CellBits& solid(int b) const { return maps_[b].solid; }
  bool is_fluid(int b, lbm::Int3 local_cell) const { return !solid(b).test(local_cell); }

  // ---- cells of a box of a block's local cells, x fastest; of solid ones they mean nothing ----
  virtual void moments(int b, const lbm::CellBox&, lbm::MomentArrays&) const = 0;
  std::array<double, 3> velocity(const lbm::Moments& m) const { return lbm::velocity_of(m, body_force_); }
  /// Population i arriving at the cells, whatever the parity; exact in double for either precision.
  virtual void read(int b, const lbm::CellBox&, int i, double* g) const = 0;
  void write(int b, const lbm::CellBox& box, int i, const double* g) {
    sums_.reset();
    set(b, box, i, g);
  }

  // ---- all fluid cells ----
  struct Fast {
    lbm::Int3 cell;  // global
    double speed;    // infinite for what is not a number
  };
  /// Returns the fastest of this rank's fluid cells that the last pass found to be faster than
  /// lbm::speed_of_sound when it began; of several the first, z before y before x.
  virtual std::optional<Fast> too_fast() const = 0;
  /// Cells are added up once between two changes.
  const FlowSums& sums() const {
    if (!sums_) sums_ = count();
    return *sums_;
  }
  /// Returns the sum of their velocities.
  rigid::Vec3 velocity_sum(const FlowTotals& t) const {
    return rigid::Vec3(t.momentum.data()) +
           0.5 * static_cast<double>(t.fluid_cells) * rigid::Vec3(body_force_.data());
  }
  /// Takes several times as long as the sums: each cell is counted in double precision.
  virtual FluidMass mass() const = 0;
  /// Returns the wrapping sum of XXH3 of global cell index and arriving populations.
  virtual std::uint64_t hash() const = 0;
  /// Returns this rank's share of the force of the fluid on a side of the domain in the last step, in
  /// lbm::link_quantum, by momentum exchange: the sum of c (f out + f back) over its links across the upper
  /// or lower side of an axis (README.md, equation 1). It is 0 where that is not a wall.
  virtual std::array<rigid::FixedSum, 3> side_force(int axis, bool upper) const = 0;
  virtual std::size_t bytes() const = 0;  // of the populations

  /// Must be called when populations or the map have changed but by write().
  void changed() { sums_.reset(); }

 protected:
  FluidFields(const lbm::Domain& domain, const std::array<double, 3>& body_force,
              const std::vector<BlockMap>& maps)
      : domain_(domain), body_force_(body_force), maps_(maps) {}

 private:
  virtual void set(int b, const lbm::CellBox&, int i, const double* g) = 0;
  virtual FlowSums count() const = 0;

  const lbm::Domain& domain_;
  std::array<double, 3> body_force_;
  const std::vector<BlockMap>& maps_;
  mutable std::optional<FlowSums> sums_;
};

/// Returns the fields of a fluid; refers to it and to the maps of its blocks.
template <class T>
std::unique_ptr<FluidFields> make_fields(lbm::Fluid<T>&, const std::vector<BlockMap>&);

/// Calls visit(global cell, moments) for every fluid cell, x fastest.
template <class Visit>
void for_each_fluid_cell(const FluidFields& fields, Visit&& visit) {
  for (int b = 0; b < fields.blocks(); ++b) {
    const lbm::CellBox& box = fields.block(b);
    lbm::MomentsByRow moments(fields, b, 0, box.size.x);
    for_cells({}, box.size, [&](lbm::Int3 x) {
      if (fields.is_fluid(b, x)) visit(box.lower + x, moments(x));
    });
  }
}

/// Puts the fluid of a case into its initial state, `fluid.initial`; the flow must be fresh, at rest
/// (initial_flow.cpp).
void set_initial_flow(const Case&, FluidFields&);

}  // namespace silt::coupler
