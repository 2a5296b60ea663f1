#pragma once
// A rank's view of the levels of cells: those of its own part of the domain and of adjacent parts. Each rank
// determines the levels of its part from the bodies of all nearby ranks and sends them to adjacent ranks.
#include <mpi.h>

#include "coupler/regions/fine_boxes.hpp"
#include "parallel/messages.hpp"

namespace silt::coupler {

/// Returns a tree with one leaf per rank and planes where faces of the coarsest border may lie. Throws
/// std::invalid_argument for too many ranks.
lbm::CutTree cut_for_levels(const FlowSpec&, int ranks);
/// Parts consist of whole tiles: coarsest_tile is their edge in finest cells, two coarsest cells; tiles_of is
/// the number of tiles. Along an axis that leaves at least half a tile over the last tile is longer.
int coarsest_tile(const FlowSpec&);
lbm::Int3 tiles_of(const FlowSpec&);
/// Convert between a tree of tiles and one of cells.
lbm::CutTree of_cells(const lbm::CutTree& of_tiles, const FlowSpec&);
lbm::CutTree of_tiles(const lbm::CutTree& of_cells, const FlowSpec&);

class LevelViews {
 public:
  /// Collective. parts: as of cut_for_levels. entrances: as in FineBoxes. Keeps references to spec and world.
  LevelViews(const FlowSpec&, std::vector<rigid::BoundingBox> entrances, lbm::CutTree parts,
             const rigid::World&, MPI_Comm);

  /// Collective. Returns the view for these bodies and walls. Leaves of other parts count as far.
  lbm::CutTree view(const rigid::BodySet& bodies) { return view(boxes_here(bodies)); }
  /// Collective. Returns the view for given levels of this rank's part.
  lbm::CutTree view(std::span<const lbm::LevelBox>);
  const lbm::CellBox& part() const { return part_; }
  /// Returns the other ranks with adjacent parts, sorted; a symmetric relation.
  const std::vector<int>& beside() const { return beside_; }

 private:
  std::vector<lbm::LevelBox> boxes_here(const rigid::BodySet&);
  lbm::LevelCut cut_from(const parallel::Bytes&) const;

  const FlowSpec& flow_;
  FineBoxes fine_;
  const rigid::World& world_;
  lbm::CutTree parts_;
  lbm::CellBox part_;
  int rank_;
  std::vector<int> beside_, in_reach_;  // in_reach_: ranks whose bodies may matter here
  std::vector<lbm::CellBox> parts_in_reach_;
  parallel::Messages messages_;
};

}  // namespace silt::coupler
