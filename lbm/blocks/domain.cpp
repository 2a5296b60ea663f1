#include "lbm/blocks/domain.hpp"

#include <algorithm>
#include <set>
#include <stdexcept>
#include <string>

#include "lbm/blocks/equal_cut.hpp"

namespace silt::lbm {

Domain::Domain(CutTree tree, const std::array<SideCondition, 6>& sides, int ranks, int level)
    : tree_(std::move(tree)), sides_(sides), ranks_(ranks), level_(level) {
  if (blocks() < ranks)
    throw std::invalid_argument("the domain is cut into " + std::to_string(blocks()) +
                                " blocks, fewer than the " + std::to_string(ranks) +
                                " ranks; make domain.blocks smaller or use fewer ranks");
}

Domain::Domain(Int3 cells, const std::array<SideCondition, 6>& sides, std::optional<Int3> block_cells,
               int ranks)
    : Domain(block_cells ? grid_cut(cells, *block_cells) : equal_cut(cells, ranks), sides, ranks) {}

std::vector<BlockPlace> Domain::blocks_of(int rank) const {
  std::vector<BlockPlace> mine;
  if (tree_.kinds().empty()) {
    for (int b = first_block(rank); b < first_block(rank + 1); ++b) mine.push_back(block(b));
    return mine;
  }
  for (int b = 0; b < blocks(); ++b)
    if (tree_.kinds()[b].rank == rank && tree_.kinds()[b].level == level_) mine.push_back(block(b));
  return mine;
}

int Domain::local_index(const BlockPlace& block, int rank) const {
  if (block.rank != rank) return -1;
  return tree_.kinds().empty() ? block.index - first_block(rank) : tree_.kinds()[block.index].place;
}

int Domain::rank_of(int block) const {
  if (!tree_.kinds().empty()) return tree_.kinds()[block].rank;
  return int(((block + std::int64_t(1)) * ranks_ - 1) / blocks());
}

Int3 Domain::wrapped(Int3 x) const {
  const Int3 n = cells();
  for (int d = 0; d < 3; ++d)
    if ((x[d] < 0 || x[d] >= n[d]) && periodic(d)) x[d] = ((x[d] % n[d]) + n[d]) % n[d];
  return x;
}

bool Domain::inside(Int3 x) const {
  return CellBox{{}, cells()}.contains(x);
}

std::vector<int> Domain::blocks_meeting(const CellBox& box) const {
  std::set<int> found;
  for_images_meeting(box, [&](const BlockPlace& place, Int3) {
    if (is_of_level(place)) found.insert(place.index);
  });
  return {found.begin(), found.end()};
}

std::vector<int> Domain::neighbourhood(int b) const {
  return blocks_meeting(grown(block(b).box, 1));
}

std::vector<int> Domain::neighbourhood_of_rank(int rank) const {
  std::set<int> found;
  for (const BlockPlace& mine : blocks_of(rank))
    for (const int n : neighbourhood(mine.index)) found.insert(n);
  return {found.begin(), found.end()};
}

}  // namespace silt::lbm
