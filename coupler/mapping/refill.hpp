#pragma once
// Cells that turn solid (covered) or fluid (uncovered), and populations of the latter.
//
// All populations that arrive at an uncovered cell are in its own block at either parity, so refilling is
// local. It averages over neighbours that were and are fluid. The moments of neighbours on other ranks are
// sent; both ends find them from their own maps, ghost cells included.
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
  const BodyMask* body;  // the mask that covers it, or that left it
};

/// The cells of this rank that the last mapping covered and uncovered, block by block.
struct ChangedCells {
  std::vector<CoveredCell> covered, uncovered;
};
ChangedCells changed_cells(const std::vector<BlockMap>&);
std::vector<lbm::LocalCell> places(const std::vector<CoveredCell>&);

/// Returns the vector from the nearest periodic image of a body's centre of mass to the centre of a cell.
rigid::Vec3 nearest_arm(const lbm::Domain&, const rigid::Vec3& position, lbm::Int3 global_cell);

/// Uncovered cells, and moments of neighbours in other blocks, as passes read them. Kept to reuse the memory.
template <class T>
struct UncoveredCells {
  Mirror<UncoveredCell> cells;
  Mirror<lbm::Moments> told;
  lbm::CellLists<T> listed;
  explicit UncoveredCells(Device device) : cells(device), told(device), listed(device) {}
};

/// Sets uncovered cells to the mean density of their neighbours, the body's velocity at the cell, and the
/// mean non-equilibrium flux of momentum, g_i = g_i^eq + 9/2 w_i (c.Pi.c - tr Pi/3). Cells of a removed body
/// take its velocity, cells without a fluid neighbour the reference density. Collective over ranks of
/// neighbouring blocks.
template <class T>
void refill(lbm::Fluid<T>&, const std::vector<BlockMap>&, const ChangedCells&, const rigid::BodySet&,
            const rigid::BodySet& gone, UncoveredCells<T>&);

}  // namespace silt::coupler
