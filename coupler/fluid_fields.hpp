#pragma once
// Reads and writes the fluid of one level on this rank by boxes of cells, whatever the precision of its
// populations, and tells which cells are fluid.
#include <array>
#include <memory>
#include <optional>
#include <vector>

#include "coupler/flow_totals.hpp"
#include "coupler/mapping/solid_map.hpp"
#include "lbm/blocks/domain.hpp"
#include "lbm/blocks/moments.hpp"
#include "lbm/collision/collision_model.hpp"

namespace silt::coupler {

struct FlowSpec;

class FluidFields {
 public:
  virtual ~FluidFields() = default;

  const lbm::Domain& domain() const { return domain_; }
  const std::vector<BlockMap>& maps() const { return maps_; }  // of this rank's blocks
  int blocks() const { return int(maps_.size()); }
  const lbm::CellBox& block(int b) const { return maps_[b].box; }  // global cells
  const CellBits& solid(int b) const { return maps_[b].solid; }
  bool is_fluid(int b, lbm::Int3 local_cell) const { return !solid(b).test(local_cell); }
  const lbm::CollisionSpec& spec() const { return spec_; }  // in units of the level

  // ---- a cell of this level in units of the finest lattice, 0; a step takes as long as a cell is wide ----
  int level() const { return domain_.level(); }
  int width() const { return 1 << level(); }
  std::int64_t volume() const { return std::int64_t{1} << 3 * level(); }
  lbm::Int3 finest(lbm::Int3 cell) const { return {cell.x * width(), cell.y * width(), cell.z * width()}; }
  /// Returns the cell of this level that contains a finest cell.
  lbm::Int3 coarse(lbm::Int3 finest) const {
    return {finest.x >> level(), finest.y >> level(), finest.z >> level()};
  }
  rigid::Vec3 centre(lbm::Int3 cell) const {
    return width() * rigid::Vec3(cell.x + 0.5, cell.y + 0.5, cell.z + 0.5);
  }
  /// Returns the volume of a cell that lies in a box, in finest cells.
  double volume_in(const rigid::BoundingBox& box, lbm::Int3 cell) const {
    const auto low = (width() * rigid::Vec3(cell.x, cell.y, cell.z)).eval();
    const rigid::Vec3 high = (low.array() + width()).min(box.upper.array());
    return (high - low.cwiseMax(box.lower)).cwiseMax(0).prod();
  }
  /// Returns the cells that overlap a box.
  lbm::CellBox cells_meeting(const rigid::BoundingBox&) const;

  // ---- cells of a box of a block's local cells, x fastest; the values of solid cells are undefined ----
  virtual void moments(int b, const lbm::CellBox&, lbm::MomentArrays&) const = 0;
  std::array<double, 3> velocity(const lbm::Moments& m) const { return lbm::velocity_of(m, spec_.force); }
  /// Returns whether the fluid has a temperature; the temperature of a cell in the case.
  virtual bool has_temperature() const = 0;
  virtual double temperature(int b, lbm::Int3 local_cell) const = 0;
  /// Returns the number of populations of a cell: after those of the fluid those of the temperature.
  int populations() const { return lbm::D3Q19::directions + (has_temperature() ? lbm::D3Q7::directions : 0); }
  /// Reads population i that arrives at the cells, at either parity; exact in double for both precisions.
  virtual void read(int b, const lbm::CellBox&, int i, double* g) const = 0;
  /// Returns the populations that left a fluid cell along i in the last pass and returned against i.
  virtual std::pair<double, double> link(int b, lbm::Int3 local_cell, int i) const = 0;
  void write(int b, const lbm::CellBox& box, int i, const double* g) {
    sums_.reset();
    set(b, box, i, g);
  }

  // ---- all fluid cells ----
  struct Fast {
    lbm::Int3 cell;  // global, of the finest lattice
    double speed;    // infinite for what is not a number
  };
  /// Returns the fastest of this rank's fluid cells that exceeded lbm::speed_of_sound when the last pass
  /// began; of several the first, ordered by z, y, x.
  virtual std::optional<Fast> too_fast() const = 0;
  /// Returns the sums over the cells, computed once between two changes.
  const FlowSums& sums() const {
    if (!sums_) sums_ = count();
    return *sums_;
  }
  /// Returns the sum of velocities over the cells of all levels. Call for the finest level.
  rigid::Vec3 velocity_sum(const FlowTotals& t) const {
    return rigid::Vec3(t.momentum.data()) +
           0.5 * static_cast<double>(t.forces) * rigid::Vec3(spec_.force.data());
  }
  /// Returns the wrapping sum of XXH3 of level, global cell index and arriving populations.
  virtual std::uint64_t hash() const = 0;
  /// Returns this rank's share of the force of the fluid on a side of the domain in the last step by momentum
  /// exchange: the sum of c (f out + f back) over its links across that side (method.md, equation 1), in
  /// lbm::link_quantum, units of the finest lattice; of a link that crosses two walls each has the component
  /// along its normal. Zero if the side is not a wall.
  virtual std::array<rigid::FixedSum, 3> side_force(int axis, bool upper) const = 0;
  /// Returns this rank's share of the sum of temperatures over fluid cells, and of the heat that the fluid
  /// lost over a side of the domain in the last step, both in lbm::heat_quantum, units of the finest lattice.
  virtual rigid::FixedSum heat() const = 0;
  virtual rigid::FixedSum side_heat(int axis, bool upper) const = 0;
  /// Returns `share` times the volume flux along an axis through a block's local cells of one layer, in
  /// flow_quantum and finest units: the sum of velocities times the face of a cell, less the flux into bodies
  /// and [[walls]] in the layer. In steady flow it is equal for all layers.
  virtual rigid::FixedSum flow_through(int axis, int b, const lbm::CellBox&, double share) const = 0;
  static constexpr double flow_quantum = 0x1p-48;
  virtual std::size_t bytes() const = 0;  // of the populations

  /// Call after a change of populations or map by any other function than write().
  void changed() { sums_.reset(); }

 protected:
  FluidFields(const lbm::Domain& domain, const lbm::CollisionSpec& spec, const std::vector<BlockMap>& maps)
      : domain_(domain), spec_(spec), maps_(maps) {}

 private:
  virtual void set(int b, const lbm::CellBox&, int i, const double* g) = 0;
  virtual FlowSums count() const = 0;

  const lbm::Domain& domain_;
  const lbm::CollisionSpec& spec_;
  const std::vector<BlockMap>& maps_;
  mutable std::optional<FlowSums> sums_;
};

/// Returns the fields of a fluid, and of its temperature if it has one; refers to both and to the maps of the
/// blocks.
template <class T>
std::unique_ptr<FluidFields> make_fields(lbm::Fluid<T>&, const std::vector<BlockMap>&,
                                         lbm::Temperature<T>* = nullptr);

/// Calls visit(global cell of the level, moments) for every fluid cell of a box, x fastest.
template <class Visit>
void for_each_fluid_cell(const FluidFields& fields, const lbm::CellBox& within, Visit&& visit) {
  for (int b = 0; b < fields.blocks(); ++b) {
    const lbm::Int3 corner = fields.block(b).lower;
    const lbm::CellBox box = overlap(fields.block(b), within);
    const lbm::Int3 first = box.lower - corner, last = first + box.size;
    lbm::MomentsByRow moments(fields, b, first.x, last.x);
    for_cells(first, last, [&](lbm::Int3 x) {
      if (fields.is_fluid(b, x)) visit(corner + x, moments(x));
    });
  }
}
/// Visits all fluid cells of the level in the same way.
template <class Visit>
void for_each_fluid_cell(const FluidFields& fields, Visit&& visit) {
  for_each_fluid_cell(fields, {{}, fields.domain().cells()}, visit);
}

/// Replaces the first populations of all cells of a block: change(global cell, its populations).
template <class Change>
void change_populations(FluidFields& fields, int b, int populations, Change&& change) {
  const lbm::CellBox& block = fields.block(b);
  lbm::CellBox plane{{}, {block.size.x, block.size.y, 1}};
  const auto cells = std::size_t(plane.cells());
  std::vector<double> g(populations * cells), of_cell(populations);
  for (; plane.lower.z < block.size.z; ++plane.lower.z) {
    for (int q = 0; q < populations; ++q) fields.read(b, plane, q, &g[q * cells]);
    std::size_t n = 0;
    const lbm::Int3 first = block.lower + plane.lower;
    for_cells(first, first + plane.size, [&](lbm::Int3 cell) {
      for (int q = 0; q < populations; ++q) of_cell[q] = g[q * cells + n];
      change(cell, of_cell);
      for (int q = 0; q < populations; ++q) g[q * cells + n] = of_cell[q];
      ++n;
    });
    for (int q = 0; q < populations; ++q) fields.write(b, plane, q, &g[q * cells]);
  }
}

// ---- the initial state (initial_flow.cpp) ----

/// Sets that of a level's fluid (InitialSpec), which must be new and at rest, and its temperature.
void set_initial_flow(const FlowSpec&, FluidFields&);
/// Sets the temperature of a level's fluid, as it moves, to that at the start; does nothing without [heat].
void set_initial_temperature(const FlowSpec&, FluidFields&);

}  // namespace silt::coupler
