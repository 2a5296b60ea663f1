#pragma once
// The temperature of a fluid with bodies (method-heat.md): what the passes of a step do with it, and the heat
// and temperature of bodies.
#include <mpi.h>

#include <map>
#include <span>
#include <vector>

#include "coupler/exchange/coupling_state.hpp"
#include "coupler/exchange/parallel_body_exchange.hpp"
#include "coupler/mapping/block_links.hpp"
#include "coupler/mapping/refill.hpp"
#include "coupler/mapping/solid_map.hpp"
#include "coupler/spec/flow_spec.hpp"
#include "lbm/blocks/domain.hpp"
#include "lbm/exchange/slot_exchange.hpp"
#include "lbm/heat/heat_links.hpp"

namespace silt::coupler {

// The solid cells into which links of several fluid cells lead, along insulating surfaces: heat passes
// through the part of them that is fluid (method-heat.md, equation H6). The links of a pocket may lie in
// several blocks, on several ranks. All find the pocket in their own maps, ghost cells included, and share
// what links tell.

class HeatPockets {
 public:
  /// Refers to the domain.
  HeatPockets(const lbm::Domain&, MPI_Comm);

  void clear();
  /// Returns the place of a link into a solid cell of a block's map along c_i (HeatLink::pocket); -1 if
  /// no other link shares that cell with it. Call once for all links of insulating surfaces, after clear().
  std::int32_t place_of(const BlockMap&, lbm::Int3 solid, int i);
  /// Lists what ranks tell each other. Call after the places of all links were asked for.
  void list_shared();

  /// What the links of this rank tell, at their places.
  std::span<lbm::PocketLink> told() { return told_; }
  /// Adds what those of other ranks tell. Collective over the ranks that share a pocket.
  void exchange();

 private:
  struct Pocket {
    std::int32_t first;             // place of its first link
    int owners[lbm::pocket_links];  // ranks of the fluid cells from which links lead there; -1: none
  };
  Pocket found(const BlockMap&, lbm::Int3 solid) const;

  const lbm::Domain& domain_;
  int rank_;
  std::map<std::int64_t, Pocket> pockets_;  // by the cell's index in the domain
  std::vector<lbm::PocketLink> told_;
  lbm::SlotExchange<double> slots_;
};

template <class T>
class HeatFlow {
 public:
  /// Refers to the fluid and the exchange.
  HeatFlow(const HeatSpec&, const std::array<BoundarySpec, 6>&, lbm::Fluid<T>&, ParallelBodyExchange&);

  lbm::Temperature<T>& temperature() { return temperature_; }
  const lbm::Temperature<T>& temperature() const { return temperature_; }

  // ---- a step, in this order ----
  /// Begins the sums of a step. Call once bodies are mapped.
  void begin_step(const rigid::BodySet&);
  /// Lets bodies take the heat of cells that they cover, and give cells that they uncover their temperature.
  void change_cells(std::span<const BlockMap>, const ChangedCells&, const rigid::BodySet&);
  /// Finds the links again of a block whose links have changed.
  void list_links(int block, const BlockMap&, const BlockLinks<T>&);
  /// Call once the links of all blocks are listed.
  void find_pockets(std::span<const BlockMap>, const rigid::BodySet&);
  /// Applies the links after the exchange of the fluid and of the temperature, and warms the bodies.
  /// Collective over ranks that hold a body.
  void exchange_heat(std::span<const BlockLinks<T>>, rigid::BodySet&);

  /// Returns this rank's share of the heat that a wall got from the fluid in the last step, in
  /// lbm::heat_quantum, by its row among those of walls.
  std::int64_t heat_of_wall(std::size_t wall) const { return wall < of_walls_.size() ? of_walls_[wall] : 0; }

 private:
  /// The sums of a row: heat, H of (H7), cells covered less uncovered, number of links.
  enum { heat, conductance, cells, links, width };
  static constexpr int shared = 3;  // numbers of a body that its copies get
  std::int64_t* sums(std::size_t row) { return sums_.data() + row * width; }
  const std::int64_t* sums(std::size_t row) const { return sums_.data() + row * width; }
  /// Returns the heat that an owned row got from the fluid in this step.
  double got(std::size_t row) const { return double(sums(row)[heat]) * lbm::heat_quantum; }
  const BodyHeat& spec_of(const rigid::BodySet&, std::size_t row) const;
  lbm::SurfaceHeat surface(const rigid::BodySet&, std::size_t row) const;
  void set_uncovered(const BlockMap&, const CoveredCell&, const lbm::SurfaceHeat&);
  void owe(rigid::BodySet&, std::size_t row);
  double foreseen_change(const rigid::BodySet&, std::size_t row) const;
  void correct(std::span<const BlockLinks<T>>, rigid::BodySet&, std::span<const double> changes);
  template <class Visit>
  void for_surfaces(std::span<const BlockLinks<T>>, Visit&&);

  HeatSpec spec_;
  lbm::Fluid<T>& fluid_;
  ParallelBodyExchange& exchange_;
  lbm::Temperature<T> temperature_;
  std::vector<std::vector<std::vector<lbm::HeatLink>>> links_;  // by block and surface
  HeatPockets pockets_;
  std::vector<std::int64_t> sums_, of_walls_;
  double passed_on_;  // share of the heat that a body got which it passes on in a step
};

}  // namespace silt::coupler
