#include "coupler/balance/foreseen_cut.hpp"

#include <algorithm>
#include <numeric>

#include "coupler/balance/best_plane.hpp"

namespace silt::coupler {
namespace {

using lbm::CellBox;

std::int64_t work_of(const CellBox& box, std::int64_t work_of_a_cell, const std::vector<WorkItem>& items) {
  std::int64_t sum = work_of_a_cell * box.cells();
  for (const WorkItem& item : items) sum += item.work;
  return sum;
}

void divide(const CellBox& box, std::int64_t work_of_a_cell, std::vector<WorkItem> items, int ranks,
            std::vector<double>& shares) {
  if (ranks == 1) return shares.push_back(double(work_of(box, work_of_a_cell, items)));
  const lbm::CutRoom room = lbm::room_to_cut(box.size, ranks);
  auto layers = work_of_layers(box, items);
  add_cells(box, work_of_a_cell, layers);
  const CutPlane plane = best_plane(box, room, layers, nearly_as_well(work_of_a_cell));
  const int at = box.lower[plane.axis] + plane.below;
  CellBox lower = box, upper = box;
  lower.size[plane.axis] = plane.below;
  upper.lower[plane.axis] = at, upper.size[plane.axis] -= plane.below;
  std::vector<WorkItem> below, above;
  for (const WorkItem& item : items) {
    const auto [a, b] = parted(item, plane.axis, at);
    if (a.work > 0) below.push_back(a);
    if (b.work > 0) above.push_back(b);
  }
  divide(lower, work_of_a_cell, std::move(below), room.lower_leaves, shares);
  divide(upper, work_of_a_cell, std::move(above), room.upper_leaves, shares);
}

WorkShares summed(const std::vector<double>& shares) {
  return {*std::max_element(shares.begin(), shares.end()),
          std::accumulate(shares.begin(), shares.end(), 0.) / double(shares.size())};
}

}  // namespace

WorkShares foreseen_cut(lbm::Int3 cells, std::int64_t work_of_a_cell, std::vector<WorkItem> items,
                        int ranks) {
  std::vector<double> shares;
  divide({{}, cells}, work_of_a_cell, std::move(items), ranks, shares);
  return summed(shares);
}

WorkShares shares_of(const lbm::Domain& domain, std::int64_t work_of_a_cell,
                     const std::vector<WorkItem>& items) {
  std::vector<double> shares(domain.ranks(), 0);
  for (int b = 0; b < domain.blocks(); ++b)
    shares[domain.rank_of(b)] += double(work_of_a_cell * domain.block(b).box.cells());
  for (const WorkItem& item : items) {
    lbm::Int3 middle;
    for (int d = 0; d < 3; ++d) middle[d] = item.box.lower[d] + item.box.size[d] / 2;
    shares[domain.rank_at(middle)] += double(item.work);
  }
  return summed(shares);
}

}  // namespace silt::coupler
