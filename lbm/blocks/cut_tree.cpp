#include "lbm/blocks/cut_tree.hpp"

#include <map>
#include <stdexcept>
#include <string>

namespace silt::lbm {

namespace {

std::vector<LeafKind> counted(std::vector<LeafKind> kinds) {
  std::map<std::pair<int, int>, int> count;
  for (LeafKind& kind : kinds) kind.place = count[{kind.rank, kind.level}]++;
  return kinds;
}

}  // namespace

CutTree::CutTree(Int3 cells, std::vector<Cut> nodes, std::vector<LeafKind> kinds)
    : cells_(cells),
      nodes_(std::make_shared<const std::vector<Cut>>(std::move(nodes))),
      kinds_(std::make_shared<const std::vector<LeafKind>>(counted(std::move(kinds)))) {
  if (!kinds_->empty() && int(kinds_->size()) != leaves())
    throw std::invalid_argument("a tree of cuts has " + std::to_string(leaves()) + " leaves and " +
                                std::to_string(kinds_->size()) + " kinds of them");
  check(whole());
}

void CutTree::check(const Part& part) const {
  if (part.leaves == 1) {
    const int level = kinds_->empty() ? 0 : (*kinds_)[part.first_leaf].level;
    for (int d = 0; d < 3 && level > 0; ++d)
      if ((part.box.lower[d] | part.box.size[d]) & ((1 << level) - 1))
        throw std::invalid_argument("leaf " + std::to_string(part.first_leaf) +
                                    " of a tree of cuts is cut through cells of level " +
                                    std::to_string(level));
    return;
  }
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
