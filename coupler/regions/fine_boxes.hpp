#pragma once
// The regions in which cells have to be fine, as boxes of cells by level: around bodies and curved walls, at
// sides and in given boxes. What they say of a cell depends on these and on poses alone.
//
// Faces of boxes of level l lie on planes 4 2^l finest cells apart, two cells of the next level; where the
// last two of an axis are nearer they are one. Each box is within one of the next level, four of its cells
// away or more, so that neighbours differ by a level at most. All unions: boxes may be cut and overlap.
#include <vector>

#include "coupler/spec/flow_spec.hpp"
#include "lbm/levels/level_cut.hpp"
#include "rigid/bodies/body_set.hpp"
#include "rigid/bodies/world.hpp"

namespace silt::coupler {

class FineBoxes {
 public:
  /// Keeps a reference to the spec, which has coarsening. Bodies may come in at any time in the entrances.
  FineBoxes(const FlowSpec&, std::vector<rigid::BoundingBox> entrances);

  /// Finest cells between the planes on which faces of a level lie.
  static int tile(int level) { return 4 << level; }
  /// The finest cells around a box, beyond the domain along periodic axes.
  lbm::CellBox around(const rigid::BoundingBox&) const;
  /// How far at most, in cells, cells of a level below the coarsest are from a box as given to around().
  int reach() const;

  /// Returns whether the cells of a box, if they are finest, may matter to a part of the domain.
  bool is_near(const lbm::CellBox&, const lbm::CellBox& part) const;

  /// Appends a box of cells and those of the next levels around it, as they lie in the domain.
  void add(lbm::CellBox, int level, std::vector<lbm::LevelBox>&) const;
  /// Appends the entrances and the given boxes.
  void add_named(std::vector<lbm::LevelBox>&) const;
  /// Appends what a curved wall at its pose asks for in a part of the domain.
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
