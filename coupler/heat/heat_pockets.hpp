#pragma once
// The solid cells into which links of several fluid cells lead, along insulating surfaces: heat passes
// through the part of them that is fluid (method-heat.md, equation H6). The links of a pocket may lie in
// several blocks, on several ranks. All find the pocket in their own maps, ghost cells included, and share
// what links tell.
#include <mpi.h>

#include <map>
#include <span>
#include <vector>

#include "coupler/mapping/solid_map.hpp"
#include "lbm/blocks/domain.hpp"
#include "lbm/exchange/slot_exchange.hpp"
#include "lbm/heat/heat_links.hpp"

namespace silt::coupler {

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

}  // namespace silt::coupler
