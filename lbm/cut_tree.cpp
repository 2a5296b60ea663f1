#include "lbm/cut_tree.hpp"

#include <stdexcept>
#include <string>

namespace silt::lbm {

CutTree::CutTree(Int3 cells, std::vector<Cut> nodes)
    : cells_(cells), nodes_(std::make_shared<const std::vector<Cut>>(std::move(nodes))) {
  check(whole());
}

void CutTree::check(const Part& part) const {
  if (part.leaves == 1) return;
  const Cut& cut = (*nodes_)[part.node];
  const bool an_axis = cut.axis >= 0 && cut.axis < 3;
  if (!an_axis || cut.lower_leaves < 1 || cut.lower_leaves >= part.leaves ||
      cut.position <= part.box.lower[cut.axis] ||
      cut.position >= part.box.lower[cut.axis] + part.box.size[cut.axis])
    throw std::invalid_argument("plane " + std::to_string(part.node) +
                                " of a tree of cuts is outside its part");
  check(lower(part));
  check(upper(part));
}

CutTree::Part CutTree::lower(const Part& part) const {
  const Cut& cut = (*nodes_)[part.node];
  Part below{part.node + 1, part.first_leaf, cut.lower_leaves, part.box};
  below.box.size[cut.axis] = cut.position - part.box.lower[cut.axis];
  return below;
}

CutTree::Part CutTree::upper(const Part& part) const {
  const Cut& cut = (*nodes_)[part.node];
  Part above{part.node + cut.lower_leaves, part.first_leaf + cut.lower_leaves, part.leaves - cut.lower_leaves,
             part.box};
  above.box.lower[cut.axis] = cut.position;
  above.box.size[cut.axis] -= cut.position - part.box.lower[cut.axis];
  return above;
}

CutTree::Leaf CutTree::leaf(int index) const {
  Part part = whole();
  while (part.leaves > 1)
    part = index < part.first_leaf + (*nodes_)[part.node].lower_leaves ? lower(part) : upper(part);
  return {part.first_leaf, part.box};
}

CutTree::Leaf CutTree::leaf_at(Int3 cell) const {
  Part part = whole();
  while (part.leaves > 1) {
    const Cut& cut = (*nodes_)[part.node];
    part = cell[cut.axis] < cut.position ? lower(part) : upper(part);
  }
  return {part.first_leaf, part.box};
}

}  // namespace silt::lbm
