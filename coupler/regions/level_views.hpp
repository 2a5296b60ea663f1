#pragma once
// How a rank sees the levels of cells: those of its own part of the domain and of the parts beside it. Each
// rank cuts its part by what the bodies of all ranks near it ask for, and tells the ranks beside it.
#include <mpi.h>

#include "coupler/regions/fine_boxes.hpp"
#include "parallel/messages.hpp"

namespace silt::coupler {

/// Returns a tree of one leaf a rank whose planes lie where faces of the coarsest border may.
/// std::invalid_argument if there are too many ranks.
lbm::CutTree cut_for_levels(const FlowSpec&, int ranks);
/// The cells of the domain, of which the ranks' parts are whole tiles: so many finest cells an edge, two of
/// the coarsest. Of an axis with half a tile over the last one is longer.
int coarsest_tile(const FlowSpec&);
lbm::Int3 tiles_of(const FlowSpec&);
/// Returns a tree of that box of tiles as one of cells, and the other way.
lbm::CutTree of_cells(const lbm::CutTree& of_tiles, const FlowSpec&);
lbm::CutTree of_tiles(const lbm::CutTree& of_cells, const FlowSpec&);

class LevelViews {
 public:
  /// Collective. Parts: as cut_for_levels. Keeps references to the spec and the world. Entrances: as of
  /// FineBoxes.
  LevelViews(const FlowSpec&, std::vector<rigid::BoundingBox> entrances, lbm::CutTree parts,
             const rigid::World&, MPI_Comm);

  /// Collective: the view that follows from bodies and walls. Leaves of a part not beside this rank's are
  /// far.
  lbm::CutTree view(const rigid::BodySet& bodies) { return view(boxes_here(bodies)); }
  /// Collective: that of given levels of the cells of this rank's part.
  lbm::CutTree view(std::span<const lbm::LevelBox>);
  const lbm::CellBox& part() const { return part_; }
  /// The other ranks whose parts are beside this one, sorted: they agree.
  const std::vector<int>& beside() const { return beside_; }

 private:
  std::vector<lbm::LevelBox> boxes_here(const rigid::BodySet&);
  lbm::LevelCut told_by(const parallel::Bytes&) const;

  const FlowSpec& flow_;
  FineBoxes fine_;
  const rigid::World& world_;
  lbm::CutTree parts_;
  lbm::CellBox part_;
  int rank_;
  std::vector<int> beside_, in_reach_;  // in_reach_: whose bodies may matter here
  std::vector<lbm::CellBox> parts_in_reach_;
  parallel::Messages messages_;
};

}  // namespace silt::coupler
