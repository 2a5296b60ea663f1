#pragma once
// The populations of cells that a body has left (uncovered), and the account of fluid that a body has
// covered.
//
// The arriving populations of an uncovered cell all belong to its own block, in either parity, so refilling
// is local. The averages it needs are over the cell's neighbours that were fluid and still are; where one
// belongs to another rank, its moments are sent: both ends find out which from their own maps, ghost cells
// included.
#include <mpi.h>

#include "coupler/mapping/refill_cell.hpp"
#include "coupler/mapping/solid_map.hpp"
#include "coupler/spec/coupling_spec.hpp"
#include "lbm/fluid.hpp"
#include "rigid/bodies/body_set.hpp"

namespace silt::coupler {

struct CoveredCell {
  int block;
  lbm::Int3 cell;        // local
  const BodyMask* body;  // that covers it; of an uncovered cell: the mask that left it
};

/// The cells of this rank that the last mapping covered and uncovered, in the order of the blocks.
struct ChangedCells {
  std::vector<CoveredCell> covered, uncovered;
};
ChangedCells changed_cells(const std::vector<BlockMap>&);
std::vector<lbm::LocalCell> places(const std::vector<CoveredCell>&);

/// A cell's centre from the nearest periodic image of a body's centre of mass.
rigid::Vec3 nearest_arm(const lbm::Domain&, const rigid::Vec3& position, lbm::Int3 global_cell);

/// The cells that were uncovered, and moments of neighbours in other blocks, as passes find them: kept from
/// step to step for their memory.
struct UncoveredCells {
  Mirror<UncoveredCell> cells;
  Mirror<lbm::Moments> told;
  explicit UncoveredCells(Device device) : cells(device), told(device) {}
};

/// `equilibrium` (the paper): mean density of the neighbours, the body's velocity at the cell. `grad`: also
/// their mean non-equilibrium momentum flux, g_i = g_i^eq + 9/2 w_i (c.Pi.c - tr Pi/3). Collective over the
/// ranks of neighbouring blocks. The fluid that takes the place of a body which has gone moves as it did;
/// where no neighbour was fluid it has the reference density.
template <class T>
void refill(lbm::Fluid<T>&, const std::vector<BlockMap>&, const ChangedCells&, const rigid::BodySet&,
            const rigid::BodySet& gone, Refill, UncoveredCells&);

}  // namespace silt::coupler
