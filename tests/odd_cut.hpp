#pragma once
// Trees of cuts as no rule would choose them: planes anywhere, parts of any shares.
#include <random>

#include "lbm/blocks/cut_tree.hpp"

namespace silt::tests {

class OddCut {
 public:
  /// edge: cells that every leaf has along each axis at least, where the box has them.
  OddCut(int edge, unsigned seed) : edge_(edge), random_(seed) {}
  lbm::CutTree operator()(lbm::Int3 cells, int leaves) {
    nodes_.clear();
    cut({{}, cells}, leaves);
    return {cells, nodes_};
  }

 private:
  long room(lbm::Int3 size) const {
    long all = 1;
    for (int d = 0; d < 3; ++d) all *= std::max(1, size[d] / edge_);
    return all;
  }
  int any(int first, int last) { return std::uniform_int_distribution<>(first, last)(random_); }

  void cut(const lbm::CellBox& box, int leaves) {
    while (leaves > 1) {
      const int axis = any(0, 2), lower = any(1, leaves - 1);
      if (box.size[axis] < 2 * edge_) continue;
      const int at = any(edge_, box.size[axis] - edge_);
      lbm::CellBox below = box, above = box;
      below.size[axis] = at;
      above.lower[axis] += at, above.size[axis] -= at;
      if (room(below.size) < lower || room(above.size) < leaves - lower) continue;
      nodes_.push_back({axis, above.lower[axis], lower});
      cut(below, lower);
      cut(above, leaves - lower);
      return;
    }
  }

  int edge_;
  std::mt19937 random_;
  std::vector<lbm::Cut> nodes_;
};

/// So many leaves of at least `edge` cells an edge; other trees for other seeds.
inline lbm::CutTree odd_cut(lbm::Int3 cells, int leaves, int edge = 2, unsigned seed = 1) {
  return OddCut(edge, seed)(cells, leaves);
}

}  // namespace silt::tests
