#pragma once
// The regions of fine cells, as boxes of cells by level: around bodies and curved walls, at sides and in
// given boxes. The level of a cell depends on these and on poses only.
//
// Faces of boxes of level l lie on planes 4 2^l finest cells apart, two cells of the next level; the last two
// planes of an axis merge if they are nearer. Each box lies inside one of the next level, at least four of
// its cells from its faces, so that adjacent levels differ by one. Boxes may overlap.
#include <vector>

#include "coupler/spec/flow_spec.hpp"
#include "lbm/levels/level_cut.hpp"
#include "rigid/bodies/body_set.hpp"
#include "rigid/bodies/world.hpp"

namespace silt::coupler {

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

}  // namespace silt::coupler
