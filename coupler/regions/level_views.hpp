#pragma once
// A rank's view of the levels of cells: those of its own part of the domain and of adjacent parts. Each rank
// determines the levels of its part from the bodies of all nearby ranks and sends them to adjacent ranks.
#include <mpi.h>

#include <vector>

#include "coupler/spec/flow_spec.hpp"
#include "lbm/levels/level_cut.hpp"
#include "parallel/messages.hpp"
#include "rigid/bodies/body_set.hpp"
#include "rigid/bodies/world.hpp"

namespace silt::coupler {

// The regions of fine cells, as boxes of cells by level: around bodies and curved walls, at sides and in
// given boxes. The level of a cell depends on these and on poses only.
//
// Faces of boxes of level l lie on planes 4 2^l finest cells apart, two cells of the next level; the last two
// planes of an axis merge if they are nearer. Each box lies inside one of the next level, at least four of
// its cells from its faces, so that adjacent levels differ by one. Boxes may overlap.

class FineBoxes {
 public:
  /// Keeps a reference to the spec, which must have coarsening. Bodies may enter in the entrances.
  FineBoxes(const FlowSpec&, std::vector<rigid::BoundingBox> entrances);

  /// Returns the distance, in finest cells, of planes on which faces of a level lie.
  static int tile(int level) { return 4 << level; }
  /// Returns the finest cells around a box, which may extend beyond the domain along periodic axes.
  lbm::CellBox around(const rigid::BoundingBox&) const;
  /// Returns the largest distance, in cells, of cells below the coarsest level from a box given to around().
  int reach() const;

  /// Returns whether finest cells in a box may influence the levels in a part of the domain.
  bool is_near(const lbm::CellBox&, const lbm::CellBox& part) const;

  /// Appends a box of cells, and the boxes of the next levels around it, wrapped into the domain.
  void add(lbm::CellBox, int level, std::vector<lbm::LevelBox>&) const;
  /// Appends the entrances and the given boxes.
  void add_named(std::vector<lbm::LevelBox>&) const;
  /// Appends the boxes that a curved wall needs in a part of the domain.
  void add_wall(const rigid::Shape&, const rigid::Pose&, const lbm::CellBox& part,
                std::vector<lbm::LevelBox>&) const;

 private:
  int plane_below(int axis, int x, int spacing) const;
  int plane_above(int axis, int x, int spacing) const;
  lbm::CellBox rounded(lbm::Int3 lower, lbm::Int3 upper, int spacing) const;
  bool is_fine(const lbm::CellBox& tiles, const rigid::Shape&, const rigid::Pose&, const lbm::CellBox& part,
               std::vector<lbm::LevelBox>&) const;

  const FlowSpec& flow_;
  const CoarseningSpec& spec_;
  std::vector<rigid::BoundingBox> entrances_;
  lbm::Int3 cells_;
  int wall_tile_ = tile(0);
};

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
