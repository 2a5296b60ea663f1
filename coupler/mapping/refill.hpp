#pragma once
// Cells that turn solid (covered) or fluid (uncovered): the populations of the latter and the mass of both.
//
// All populations that arrive at an uncovered cell are in its own block at either parity, so refilling is
// local. It averages over neighbours that were and are fluid. The moments of neighbours on other ranks are
// sent; both ends find them from their own maps, ghost cells included.
#include <mpi.h>

#include "coupler/mapping/refill_cell.hpp"
#include "coupler/mapping/solid_map.hpp"
#include "coupler/spec/flow_spec.hpp"
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

/// A neighbour along c_k, on another rank, of a cell (global, not wrapped).
struct RemoteNeighbour {
  int rank;
  lbm::Int3 cell;
  int k;
};

/// What happens to the cells of this rank that a mapping has changed: passes list them once, as offsets in
/// their block. The processor handles what other ranks send.
template <class T>
class TurnedCells {
 public:
  explicit TurnedCells(Device device)
      : cells_(device),
        momenta_(device),
        faces_(device),
        places_(device),
        told_(device),
        near_(device),
        listed_near_(device),
        masses_(device),
        left_(device),
        sent_(device) {}

  /// Sets uncovered cells to the mean density of their neighbours, the body's velocity at the cell, and the
  /// mean non-equilibrium flux of momentum, g_i = g_i^eq + 9/2 w_i (c.Pi.c - tr Pi/3). Cells of a removed
  /// body take its velocity, cells without a fluid neighbour the reference density. Collective over ranks of
  /// neighbouring blocks.
  void refill(lbm::Fluid<T>&, const std::vector<BlockMap>&, const ChangedCells&, const rigid::BodySet&,
              const rigid::BodySet& gone);
  /// Weighs the mass that cells pass on: a covered cell gives its density deviation to the fluid around it,
  /// and an uncovered cell takes it from there (method.md, equations 46 and 47), so that moving bodies
  /// conserve mass with any sides. Call after refill(), before covered cells change. Returns the mass, in
  /// lbm::mass_quantum, of cells without a fluid neighbour. Collective over neighbour ranks.
  rigid::FixedSum weigh(lbm::Fluid<T>&, const std::vector<BlockMap>&);
  /// Gives the masses to the neighbours, once: after the collision, since their sum with an older excess
  /// would be rounded.
  void give(lbm::Fluid<T>&);

 private:
  /// Covered (sign 1) or uncovered (-1) cells of a block.
  struct Range {
    int block, sign;
    std::uint32_t first, count;  // in cells_
  };
  void list(lbm::Fluid<T>&, const std::vector<BlockMap>&, const ChangedCells&);
  void list_faces(lbm::Fluid<T>&, const std::vector<BlockMap>&, const ChangedCells&);
  void take_from_others(lbm::Fluid<T>&, const std::vector<BlockMap>&);
  CellsAtFaces faces() const { return {faces_.device(), std::int64_t(faces_.size()), places_.device()}; }
  ChangedInBlock<T> in_block(lbm::Fluid<T>&, const Range&);
  PassingCells<T> passing(lbm::Fluid<T>&, const Range&, std::int64_t* sent);

  Mirror<ChangedCell> cells_;  // uncovered, then covered, each block by block
  std::vector<Range> ranges_;  // empty once masses were given
  Mirror<std::array<double, 3>> momenta_;
  Mirror<FaceCell> faces_;  // this and the next: CellsAtFaces
  Mirror<std::uint32_t> places_;
  std::vector<RemoteNeighbour> remote_;  // by their places
  std::vector<lbm::LocalCell> near_cells_;
  Mirror<lbm::Moments> told_, near_;
  lbm::CellLists<T> listed_near_;
  Mirror<std::int64_t> masses_, left_, sent_;
  std::vector<lbm::LocalCell> takers_;  // cells that other ranks give these masses
  std::vector<std::int64_t> taken_;
};

}  // namespace silt::coupler
