#pragma once
// The cut of a box of cells into leaves: a plane cuts the box in two, other planes cut each part, and so on.
// Leaves are numbered part by part, those of the lower part first. The planes are the nodes of a binary tree,
// stored in preorder with 12 bytes each:
//
//     node k: a part with n leaves;   its lower part with m leaves: node k + 1;   the upper one: node k + m
//
// The leaf of a cell and the leaves near a box are found by descending the tree.
//
// Leaves may have a kind: their rank, and the level of their cells, whose edges are 2^level. Each rank then
// has a tree of its own part of the box and those near it; any other part is a leaf of level `far`.
#include <memory>
#include <span>
#include <vector>

#include "lbm/blocks/block.hpp"

namespace silt::lbm {

/// A plane across an axis: cells whose coordinate is below `position` belong to the lower part.
struct Cut {
  std::int32_t axis, position, lower_leaves;
  bool operator==(const Cut&) const = default;
};

struct LeafKind {
  static constexpr int far = -1;
  std::int32_t rank;
  std::int32_t level = 0;  // far: a part whose cells this rank does not know
  std::int32_t place = 0;  // among the leaves of this rank and level; set by the tree
  bool operator==(const LeafKind&) const = default;
};

class CutTree {
 public:
  struct Leaf {
    int index;
    CellBox box;
  };

  /// Makes one leaf of the box of cells [0, cells).
  explicit CutTree(Int3 cells) : CutTree(cells, {}) {}
  /// Takes the nodes in preorder, and the kinds of the leaves or none. Throws std::invalid_argument if a
  /// plane does not cut its part in two, or if a leaf does not consist of whole cells of its level.
  CutTree(Int3 cells, std::vector<Cut> nodes, std::vector<LeafKind> kinds = {});

  Int3 cells() const { return cells_; }
  int leaves() const { return static_cast<int>(nodes_->size()) + 1; }
  std::span<const Cut> nodes() const { return *nodes_; }
  /// Returns the kinds of the leaves, or nothing if they have none.
  std::span<const LeafKind> kinds() const { return *kinds_; }
  bool operator==(const CutTree& other) const {
    return cells_ == other.cells_ && *nodes_ == *other.nodes_ && *kinds_ == *other.kinds_;
  }
  Leaf leaf(int index) const;
  Leaf leaf_at(Int3 cell) const;
  /// Calls visit(leaf) for every leaf that overlaps the box, in the order of leaves.
  template <class Visit>
  void for_leaves_meeting(const CellBox& box, Visit&& visit) const {
    visit_below(whole(), box, visit);
  }

 private:
  struct Part {  // a node, or a leaf where leaves is 1
    int node, first_leaf, leaves;
    CellBox box;
  };
  Part whole() const { return {0, 0, leaves(), {{}, cells_}}; }
  Part lower(const Part&) const;
  Part upper(const Part&) const;
  void check(const Part&) const;
  template <class Visit>
  void visit_below(const Part& part, const CellBox& box, Visit& visit) const {
    if (part.leaves == 1) return visit(Leaf{part.first_leaf, part.box});
    const Cut& cut = (*nodes_)[part.node];
    if (box.lower[cut.axis] < cut.position) visit_below(lower(part), box, visit);
    if (box.lower[cut.axis] + box.size[cut.axis] > cut.position) visit_below(upper(part), box, visit);
  }

  Int3 cells_;
  std::shared_ptr<const std::vector<Cut>> nodes_;  // shared by all copies
  std::shared_ptr<const std::vector<LeafKind>> kinds_;
};

}  // namespace silt::lbm
