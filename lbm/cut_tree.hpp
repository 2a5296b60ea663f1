#pragma once
// How a box of cells is cut into smaller ones: by a plane, then each part by a plane of its own, and so on.
// The boxes that are left, the leaves, are numbered so that those of a part count on, the lower part's first.
// A node of this binary tree is a plane; they are kept in preorder, 12 bytes each:
//
//     node k: a part with n leaves;   its lower part with m leaves: node k + 1;   the upper one: node k + m
//
// Who knows the tree finds the leaf of a cell, or the leaves near a box, by descending it.
#include <memory>
#include <span>
#include <vector>

#include "lbm/block.hpp"

namespace silt::lbm {

/// A plane across an axis: cells below `position` along it are of the lower part.
struct Cut {
  std::int32_t axis, position, lower_leaves;
};

class CutTree {
 public:
  struct Leaf {
    int index;
    CellBox box;
  };

  /// The box of cells from 0 on, in one leaf.
  explicit CutTree(Int3 cells) : CutTree(cells, {}) {}
  /// The nodes in preorder. std::invalid_argument for planes that do not cut their part in two.
  CutTree(Int3 cells, std::vector<Cut> nodes);

  Int3 cells() const { return cells_; }
  int leaves() const { return static_cast<int>(nodes_->size()) + 1; }
  std::span<const Cut> nodes() const { return *nodes_; }
  Leaf leaf(int index) const;
  /// The leaf of a cell inside the box.
  Leaf leaf_at(Int3 cell) const;
  /// Calls visit(leaf) for every leaf that has a cell of this box, in order.
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
  std::shared_ptr<const std::vector<Cut>> nodes_;  // one table, however many copies
};

}  // namespace silt::lbm
