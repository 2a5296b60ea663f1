#pragma once
// Cells that change sides: the populations of those that a body has left (uncovered), and the mass of both.
//
// The arriving populations of an uncovered cell all belong to its own block, in either parity, so refilling
// is local. The averages it needs are over the cell's neighbours that were fluid and still are; where one
// belongs to another rank, its moments are sent: both ends find out which from their own maps, ghost cells
// included.
//
// A cell that a body covers leaves its deviation of density to the fluid around it, and one that a body has
// left takes it from there (method.md, equations 46 and 47), so that bodies which move change no mass,
// wherever the sides of the domain are open.
#include <mpi.h>

#include "coupler/mapping/refill_cell.hpp"
#include "coupler/mapping/solid_map.hpp"
#include "coupler/spec/coupling_spec.hpp"
#include "lbm/fluid.hpp"
#include "rigid/bodies/body_set.hpp"
#include "rigid/math/exact_sum.hpp"

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

/// Gives uncovered cells the mean density of their neighbours, the body's velocity at the cell and the
/// neighbours' mean non-equilibrium momentum flux, g_i = g_i^eq + 9/2 w_i (c.Pi.c - tr Pi/3). Collective over
/// the ranks of neighbouring blocks. The fluid that takes the place of a body which has gone moves as it did;
/// where no neighbour was fluid it has the reference density.
template <class T>
void refill(lbm::Fluid<T>&, const std::vector<BlockMap>&, const ChangedCells&, const rigid::BodySet&,
            const rigid::BodySet& gone, UncoveredCells&);

/// The mass that cells of this rank get from their neighbours which changed sides, in quanta of
/// lbm/blocks/excess.hpp. They get it after they have collided: before that they would have to give up their
/// excess first, because the sum of both is rounded otherwise.
struct PassedMass {
  std::vector<lbm::LocalCell> cells;
  std::vector<std::int64_t> masses;
  rigid::FixedSum left = 0;  // in lbm::mass_quantum, for which there was no neighbour that stayed fluid
};

/// Collective over the ranks of neighbouring blocks, after refill(): covered cells still have what they held.
template <class T>
PassedMass pass_on_mass(lbm::Fluid<T>&, const std::vector<BlockMap>&, const ChangedCells&);

}  // namespace silt::coupler
