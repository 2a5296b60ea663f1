#pragma once
// Cuts a box of cells into leaves of one level each, given boxes in which cells must be fine.
#include <map>

#include "lbm/blocks/cut_tree.hpp"

namespace silt::lbm {

/// Demands cells of this level or a finer one in a box.
struct LevelBox {
  CellBox box;
  std::int32_t level;
};

/// A part of a tree of cuts: its nodes in preorder, and the level of each leaf.
struct LevelCut {
  std::vector<Cut> nodes;
  std::vector<std::int32_t> levels;
};

/// Cuts a part (in finest cells) into leaves of one level: the finest level of the boxes over a cell,
/// `coarsest` outside them. Boxes may overlap and reach beyond the part. Leaves are few but not the fewest
/// (seven for a box in the middle), and depend on the boxes alone.
LevelCut level_cut(const CellBox& part, std::span<const LevelBox>, int coarsest);

/// Returns a rank's view: each rank's part is a leaf of level `far`, unless `cuts` resolves it.
CutTree view_of(const CutTree& parts, const std::map<int, LevelCut>& cuts);

}  // namespace silt::lbm
