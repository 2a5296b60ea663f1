#pragma once
// The global box of cells, its sides, how it is cut into blocks, and which rank holds which block. Where a
// scene has cells of several levels there is one domain a level, of the same box and sides: its cells are of
// that level, and so are its blocks, which leave the rest of the box to others.
#include <array>
#include <optional>
#include <vector>

#include "lbm/blocks/cut_tree.hpp"
#include "lbm/blocks/side_kinds.hpp"

namespace silt::lbm {

struct BlockPlace {
  int index;
  CellBox box;
  int rank;
};

/// Cells of an axis from `first` on; along a periodic axis they may continue at its beginning.
struct CellRun {
  int first, count;
};

class Domain {
 public:
  /// Sides are in the order x low, x high, y low, ... Each leaf of the tree is a block, and ranks have
  /// contiguous runs of blocks whose lengths differ by one at most. If leaves have kinds, these say the
  /// ranks, and only the leaves of the level are blocks; edges of the box are then whole cells of the level.
  /// std::invalid_argument for fewer blocks than ranks.
  Domain(CutTree, const std::array<SideCondition, 6>& sides, int ranks, int level = 0);
  /// Makes blocks of about so many cells along each axis; without that, one of the same size a rank
  /// (equal_cut.hpp).
  Domain(Int3 cells, const std::array<SideCondition, 6>& sides, std::optional<Int3> block_cells, int ranks);

  int level() const { return level_; }
  Int3 cells() const { return coarsened(tree_.cells()); }
  bool periodic(int axis) const { return sides_[2 * axis].kind == SideKind::periodic; }
  const SideCondition& side(int axis, bool upper) const { return sides_[2 * axis + upper]; }
  const std::array<SideCondition, 6>& sides() const { return sides_; }
  void set_side_velocity(int side, const std::array<double, 3>& velocity) {
    sides_[side].velocity = velocity;
  }
  const CutTree& tree() const { return tree_; }
  int ranks() const { return ranks_; }
  int blocks() const { return tree_.leaves(); }
  BlockPlace block(int index) const { return placed(tree_.leaf(index)); }
  std::vector<BlockPlace> blocks_of(int rank) const;
  /// The place of a block among those of a rank, -1 for one of another rank.
  int local_index(const BlockPlace& block, int rank) const;
  int rank_of(int block) const;
  /// Returns the leaf of a cell inside the domain, which may be of another level.
  BlockPlace block_at(Int3 cell) const { return placed(tree_.leaf_at(refined(cell))); }
  bool is_of_level(const BlockPlace& block) const {
    return tree_.kinds().empty() || tree_.kinds()[block.index].level == level_;
  }
  /// Returns whether this rank knows which cells a leaf has.
  bool is_known(const BlockPlace& block) const {
    return tree_.kinds().empty() || tree_.kinds()[block.index].level != LeafKind::far;
  }
  bool has(Int3 cell) const { return is_of_level(block_at(cell)); }
  int rank_at(Int3 cell) const { return rank_of(tree_.leaf_at(refined(cell)).index); }
  /// The image of a cell that lies in the domain along the periodic axes.
  Int3 wrapped(Int3 cell) const;
  bool inside(Int3 cell) const;
  /// The bouncing sides behind which a cell lies: -1 or 1 along their axes, else 0.
  Int3 walls_met(Int3 cell) const;
  /// c_j . u of what meets these walls (as from walls_met). Through an edge each counts only with its
  /// velocity across it: the walls that meet there leave a corner at rest. With the lid's alone, the jets of
  /// a lid-driven square at Reynolds number 1000, 65 cells, are a tenth too weak.
  double wall_velocity_along(Int3 walls, Int3 along) const;
  /// Calls visit(BlockPlace) for every block of the level that has a cell of a box, or in these runs, one an
  /// axis; more than once if runs go on at the beginning of an axis.
  template <class Visit>
  void for_blocks_meeting(const CellBox&, Visit&& visit) const;
  /// Visits leaves of any level in the same way, and parts that are not known.
  template <class Visit>
  void for_leaves_meeting(const CellBox&, Visit&& visit) const;
  template <class Visit>
  void for_blocks_meeting(const std::array<CellRun, 3>& runs, Visit&& visit) const;
  /// Returns the blocks of the level that meet a box, through periods too (sorted, each once).
  std::vector<int> blocks_meeting(const CellBox&) const;
  /// Returns the blocks that share a part of a face, edge or corner with block b, and b itself (sorted).
  std::vector<int> neighbourhood(int b) const;
  /// The neighbourhoods of all blocks of a rank together (sorted, each block once): ranks that walk them in
  /// this order agree on what messages between them hold.
  std::vector<int> neighbourhood_of_rank(int rank) const;

 private:
  BlockPlace placed(const CutTree::Leaf& leaf) const {
    return {leaf.index, {coarsened(leaf.box.lower), coarsened(leaf.box.size)}, rank_of(leaf.index)};
  }
  /// refined() turns cells of the level into cells of the tree, coarsened() does the reverse.
  Int3 refined(Int3 x) const { return {x.x << level_, x.y << level_, x.z << level_}; }
  Int3 coarsened(Int3 x) const { return {x.x >> level_, x.y >> level_, x.z >> level_}; }
  int first_block(int rank) const { return int(std::int64_t(blocks()) * rank / ranks_); }

  CutTree tree_;
  std::array<SideCondition, 6> sides_;
  int ranks_, level_;
};

template <class Visit>
void Domain::for_leaves_meeting(const CellBox& box, Visit&& visit) const {
  tree_.for_leaves_meeting({refined(box.lower), refined(box.size)},
                           [&](const CutTree::Leaf& leaf) { visit(placed(leaf)); });
}

template <class Visit>
void Domain::for_blocks_meeting(const CellBox& box, Visit&& visit) const {
  for_leaves_meeting(box, [&](const BlockPlace& place) {
    if (is_of_level(place)) visit(place);
  });
}

template <class Visit>
void Domain::for_blocks_meeting(const std::array<CellRun, 3>& runs, Visit&& visit) const {
  const Int3 n = cells();
  for (int part = 0; part < 8; ++part) {  // along each axis the cells before its end, and those that go on
    CellBox box;
    for (int d = 0; d < 3; ++d) {
      const int before_end = std::min(runs[d].count, n[d] - runs[d].first);
      const bool goes_on = part >> d & 1;
      box.lower[d] = goes_on ? 0 : runs[d].first;
      box.size[d] = goes_on ? runs[d].count - before_end : before_end;
    }
    if (box.size.x > 0 && box.size.y > 0 && box.size.z > 0) for_blocks_meeting(box, visit);
  }
}

}  // namespace silt::lbm
