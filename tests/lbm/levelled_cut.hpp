#pragma once
// Trees of cuts for cells of several levels, from the level of each cell: leaves of one level each, given to
// ranks in turn.
#include <functional>
#include <optional>
#include <vector>

#include "lbm/blocks/cut_tree.hpp"

namespace silt::lbm::testing {

/// level(x) is that of the finest cell x; it changes at multiples of `tile` alone. No leaf is longer than
/// `longest` finest cells, if that is given.
class LevelledCut {
 public:
  using LevelOf = std::function<int(Int3)>;
  LevelledCut(Int3 cells, int tile, LevelOf level, int ranks = 1, int longest = 1 << 30, LevelOf rank_at = {})
      : tile_(tile),
        longest_(longest),
        ranks_(ranks),
        level_(std::move(level)),
        rank_(std::move(rank_at)),
        cells_(cells) {
    cut({{}, cells});
  }
  CutTree tree() const { return CutTree(cells_, nodes_, kinds_); }

 private:
  int kind_of(Int3 x) const { return level_(x) + (rank_ ? 100 * rank_(x) : 0); }
  std::vector<int> layer(const CellBox& box, int d, int at) const {
    std::vector<int> levels;
    CellBox one = box;
    one.lower[d] = at, one.size[d] = 1;
    lbm::for_cells({},
                   {(one.size.x + tile_ - 1) / tile_, (one.size.y + tile_ - 1) / tile_,
                    (one.size.z + tile_ - 1) / tile_},
                   [&](Int3 t) {
                     levels.push_back(kind_of(one.lower + Int3{t.x * tile_, t.y * tile_, t.z * tile_}));
                   });
    return levels;
  }
  /// Returns where it is to be cut: as near to the middle as it changes, or where it is too long.
  std::optional<Cut> plane(const CellBox& box) const {
    std::optional<Cut> best;
    int best_off = 1 << 30;
    for (int d = 0; d < 3; ++d)
      for (int x = box.lower[d] + tile_; x < box.lower[d] + box.size[d]; x += tile_) {
        const int off = std::abs(2 * (x - box.lower[d]) - box.size[d]);
        if (off < best_off && (layer(box, d, x) != layer(box, d, x - tile_) || box.size[d] > longest_))
          best = Cut{d, x, 0}, best_off = off;
      }
    return best;
  }
  int cut(const CellBox& box) {
    const std::optional<Cut> where = plane(box);
    if (!where) {
      kinds_.push_back({rank_ ? rank_(box.lower) : int(kinds_.size()) % ranks_, level_(box.lower)});
      return 1;
    }
    const std::size_t node = nodes_.size();
    nodes_.push_back(*where);
    CellBox below = box, above = box;
    below.size[where->axis] = where->position - box.lower[where->axis];
    above.lower[where->axis] = where->position;
    above.size[where->axis] -= below.size[where->axis];
    const int lower = cut(below);
    nodes_[node].lower_leaves = lower;
    return lower + cut(above);
  }

  int tile_, longest_, ranks_;
  LevelOf level_, rank_;
  Int3 cells_;
  std::vector<Cut> nodes_;
  std::vector<LeafKind> kinds_;
};

}  // namespace silt::lbm::testing
