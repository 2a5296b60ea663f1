#include "lbm/levels/level_cut.hpp"

#include <algorithm>

namespace silt::lbm {

namespace {

/// Returns the boxes, clipped to the part, that demand cells finer than `level`; boxes that cover the whole
/// part lower `level` first.
std::vector<LevelBox> that_refine(const CellBox& part, std::span<const LevelBox> boxes, int& level) {
  std::vector<LevelBox> inside;
  for (const LevelBox& b : boxes) {
    const LevelBox clipped{overlap(b.box, part), b.level};
    if (clipped.box.cells() == part.cells())
      level = std::min<int>(level, b.level);
    else if (clipped.box.cells() > 0)
      inside.push_back(clipped);
  }
  std::erase_if(inside, [&](const LevelBox& b) { return b.level >= level; });
  return inside;
}

struct Plane {
  int axis = -1, position = 0;
  double worth = 0;
};

/// Returns the plane through faces of boxes with the largest ratio of faces on it to cells cut by it. What
/// crosses a cut across x takes four times as long, an element of a cache line each.
Plane best_plane(const CellBox& part, std::span<const LevelBox> boxes) {
  Plane best;
  for (int d = 2; d >= 0; --d) {  // ties favour the last axis, for long rows
    const int n = part.size[d];
    std::vector<std::int64_t> cut_cells(n + 1, 0), face_cells(n + 1, 0);
    for (const LevelBox& b : boxes) {
      const int lower = b.box.lower[d] - part.lower[d], upper = lower + b.box.size[d];
      const std::int64_t face = b.box.cells() / b.box.size[d];
      cut_cells[lower + 1] += face, cut_cells[upper] -= face;
      face_cells[lower] += face, face_cells[upper] += face;
    }
    for (int x = 1; x < n; ++x) {
      cut_cells[x] += cut_cells[x - 1];
      const double worth = double(face_cells[x]) / double(1 + (d == 0 ? 4 : 1) * cut_cells[x]);
      if (worth > best.worth) best = {d, part.lower[d] + x, worth};
    }
  }
  return best;
}

/// Appends the nodes and leaves of a part, of this level outside the boxes.
void cut(const CellBox& part, std::span<const LevelBox> boxes, int level, LevelCut& result) {
  const std::vector<LevelBox> inside = that_refine(part, boxes, level);
  if (inside.empty()) return result.levels.push_back(level);
  const Plane plane = best_plane(part, inside);
  CellBox lower = part, upper = part;
  lower.size[plane.axis] = plane.position - part.lower[plane.axis];
  upper.lower[plane.axis] = plane.position;
  upper.size[plane.axis] -= lower.size[plane.axis];
  const std::size_t node = result.nodes.size(), first = result.levels.size();
  result.nodes.push_back({plane.axis, plane.position, 0});
  cut(lower, inside, level, result);
  const std::size_t middle = result.levels.size();
  cut(upper, inside, level, result);
  result.nodes[node].lower_leaves = int(middle - first);
  if (result.levels.size() == first + 2 && result.levels[first] == result.levels[middle]) {  // one leaf
    result.nodes.pop_back();
    result.levels.pop_back();
  }
}

/// Replaces leaves of the tree of parts by the cuts of ranks.
class Grafting {
 public:
  Grafting(const CutTree& parts, const std::map<int, LevelCut>& cuts) : parts_(parts), cuts_(cuts) {
    add(0, 0, parts.leaves());
  }
  CutTree tree() && { return {parts_.cells(), std::move(nodes_), std::move(kinds_)}; }

 private:
  /// Appends the subtree of a node of the tree of parts; `leaves` is its number of leaves.
  void add(int node, int rank, int leaves) {
    if (leaves == 1) return add_part(rank);
    const Cut& cut = parts_.nodes()[node];
    const std::size_t at = nodes_.size(), before = kinds_.size();
    nodes_.push_back(cut);
    add(node + 1, rank, cut.lower_leaves);
    nodes_[at].lower_leaves = std::int32_t(kinds_.size() - before);
    add(node + cut.lower_leaves, rank + cut.lower_leaves, leaves - cut.lower_leaves);
  }
  void add_part(int rank) {
    const auto found = cuts_.find(rank);
    if (found == cuts_.end()) return kinds_.push_back({rank, LeafKind::far});
    const LevelCut& cut = found->second;
    nodes_.insert(nodes_.end(), cut.nodes.begin(), cut.nodes.end());
    for (const int level : cut.levels) kinds_.push_back({rank, level});
  }

  const CutTree& parts_;
  const std::map<int, LevelCut>& cuts_;
  std::vector<Cut> nodes_;
  std::vector<LeafKind> kinds_;
};

}  // namespace

LevelCut level_cut(const CellBox& part, std::span<const LevelBox> boxes, int coarsest) {
  LevelCut result;
  cut(part, boxes, coarsest, result);
  return result;
}

CutTree view_of(const CutTree& parts, const std::map<int, LevelCut>& cuts) {
  return Grafting(parts, cuts).tree();
}

}  // namespace silt::lbm
