#pragma once
// The global box of cells, its sides, its cut into blocks, and the rank of each block. With cells of several
// levels each level has a domain: all have the same box and sides, but the cells and blocks of their own
// level, which fill a part of the box.
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

/// `count` cells along an axis from `first` on; along a periodic axis they may continue at its beginning.
struct CellRun {
  int first, count;
};

class Domain {
 public:
  /// Takes the sides in the order x low, x high, y low, ... Each leaf of the tree is a block. Each rank has a
  /// contiguous run of blocks; the lengths of these runs differ by one at most. If the leaves have kinds,
  /// these give the ranks, and only leaves of this level are blocks; the edges of the box must be whole cells
  /// of the level. Throws std::invalid_argument for fewer blocks than ranks.
  Domain(CutTree, const std::array<SideCondition, 6>& sides, int ranks, int level = 0);
  /// Cuts the box into blocks of about block_cells cells along each axis, or else into one block of equal
  /// size per rank (equal_cut.hpp).
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
  /// Returns the index of a block among the blocks of a rank, or -1 if another rank has it.
  int local_index(const BlockPlace& block, int rank) const;
  int rank_of(int block) const;
  /// Returns the leaf of a cell inside the domain, which may be of another level.
  BlockPlace block_at(Int3 cell) const { return placed(tree_.leaf_at(refined(cell))); }
  bool is_of_level(const BlockPlace& block) const {
    return tree_.kinds().empty() || tree_.kinds()[block.index].level == level_;
  }
  /// Returns whether this rank knows the cells of a leaf (not LeafKind::far).
  bool is_known(const BlockPlace& block) const {
    return tree_.kinds().empty() || tree_.kinds()[block.index].level != LeafKind::far;
  }
  bool has(Int3 cell) const { return is_of_level(block_at(cell)); }
  int rank_at(Int3 cell) const { return rank_of(tree_.leaf_at(refined(cell)).index); }
  /// Returns the periodic image of a cell that lies in the domain along the periodic axes.
  Int3 wrapped(Int3 cell) const;
  bool inside(Int3 cell) const;
  /// Returns the bouncing sides behind which a cell lies, per axis: -1 (low), 1 (high) or 0.
  Int3 walls_met(Int3 cell) const { return lbm::walls_met(sides_, cells(), cell); }
  /// Returns c_j . u of a population (along: c_j) that meets these walls.
  double wall_velocity_along(Int3 walls, Int3 along) const {
    return lbm::wall_velocity_along(sides_, walls, along);
  }
  /// Calls visit(BlockPlace) for every block of this level that overlaps a box, or the runs of the three
  /// axes; more than once if a run continues at the beginning of a periodic axis.
  template <class Visit>
  void for_blocks_meeting(const CellBox&, Visit&& visit) const;
  /// Visits the leaves of all levels in the same way, including those whose cells are not known.
  template <class Visit>
  void for_leaves_meeting(const CellBox&, Visit&& visit) const;
  template <class Visit>
  void for_blocks_meeting(const std::array<CellRun, 3>& runs, Visit&& visit) const;
  /// Calls visit(BlockPlace, way) for the leaves of all levels that lie in a box when moved by `way`, a
  /// multiple of the periods: once for each such image of a leaf.
  template <class Visit>
  void for_images_meeting(const CellBox&, Visit&& visit) const;
  /// Returns the sorted indices of the blocks of this level that overlap a box or its periodic images.
  std::vector<int> blocks_meeting(const CellBox&) const;
  /// Returns the sorted indices of the blocks that touch block b at a face, edge or corner, with b itself.
  std::vector<int> neighbourhood(int b) const;
  /// Returns the sorted union of the neighbourhoods of a rank's blocks. Ranks that walk their blocks in this
  /// order agree on the contents of the messages between them.
  std::vector<int> neighbourhood_of_rank(int rank) const;

 private:
  BlockPlace placed(const CutTree::Leaf& leaf) const {
    return {leaf.index, {coarsened(leaf.box.lower), coarsened(leaf.box.size)}, rank_of(leaf.index)};
  }
  /// Converts cells of the level to cells of the tree; coarsened() does the reverse.
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
  for (int part = 0; part < 8; ++part) {  // per axis: cells up to its end, cells wrapped to its start
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

template <class Visit>
void Domain::for_images_meeting(const CellBox& box, Visit&& visit) const {
  const Int3 n = cells();
  const auto periods = [&](int d) { return periodic(d) ? 1 : 0; };
  const Int3 most{periods(0), periods(1), periods(2)};
  for_cells(Int3{} - most, most + Int3{1, 1, 1}, [&](Int3 times) {
    const Int3 way{times.x * n.x, times.y * n.y, times.z * n.z};
    const CellBox image = overlap({box.lower - way, box.size}, {{}, n});
    if (image.cells() > 0) for_leaves_meeting(image, [&](const BlockPlace& place) { visit(place, way); });
  });
}

}  // namespace silt::lbm
