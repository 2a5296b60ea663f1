#pragma once
// How a box of cells is cut into leaves of one level each, from boxes that say where cells have to be fine.
#include <map>

#include "lbm/blocks/cut_tree.hpp"

namespace silt::lbm {

/// Cells in the box are of this level or of a finer one.
struct LevelBox {
  CellBox box;
  std::int32_t level;
};

/// A part of a tree of cuts: its nodes in preorder, and the level of each leaf.
struct LevelCut {
  std::vector<Cut> nodes;
  std::vector<std::int32_t> levels;
};

/// Cuts a part of the finest cells so that each leaf is of one level: of a cell the least of the boxes that
/// it is in, `coarsest` outside of all. Boxes may overlap and stick out. Leaves are few, not fewest: seven of
/// a box in the middle. The same boxes give the same leaves.
LevelCut level_cut(const CellBox& part, std::span<const LevelBox>, int coarsest);

/// Returns the view of a rank: a tree of one leaf a rank, far but for the parts of some ranks, which are cut.
CutTree view_of(const CutTree& parts, const std::map<int, LevelCut>& cuts);

}  // namespace silt::lbm
