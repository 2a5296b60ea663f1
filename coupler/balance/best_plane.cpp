#include "coupler/balance/best_plane.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>

namespace silt::coupler {

using lbm::CellBox;

namespace {

/// The share of an item's work in its first cells along an axis.
std::int64_t work_below(const WorkItem& item, int axis, int cells) {
  return item.work * cells / item.box.size[axis];
}

CutPlane best_across(int axis, const CellBox& box, const lbm::CutRoom& room,
                     std::span<const std::uint64_t> layers) {
  const auto range = room.along(axis, box.size);
  if (range.empty()) return {};
  const double all = double(std::accumulate(layers.begin(), layers.end(), std::uint64_t(0)));
  const double even = double(box.size[axis]) * room.lower_leaves / (room.lower_leaves + room.upper_leaves);
  CutPlane best;
  std::uint64_t below = 0;
  for (int at = 1; at <= range.last; ++at) {
    below += layers[at - 1];
    if (at < range.first) continue;
    const double largest =
        std::max(double(below) / room.lower_leaves, (all - double(below)) / room.upper_leaves);
    if (best.axis < 0 || largest < best.largest ||
        (largest == best.largest && std::abs(at - even) < std::abs(best.below - even)))
      best = {axis, at, largest, lbm::cost_of_face(axis) * double(box.cells() / box.size[axis])};
  }
  return best;
}

}  // namespace

std::vector<std::uint64_t> work_of_layers(const CellBox& box, std::span<const WorkItem> items) {
  std::vector<std::uint64_t> work(box.size.x + box.size.y + box.size.z, 0);
  for (const WorkItem& item : items) {
    std::size_t first = 0;
    for (int d = 0; d < 3; first += box.size[d++])
      for (int k = 0; k < item.box.size[d]; ++k)
        work[first + item.box.lower[d] - box.lower[d] + k] +=
            work_below(item, d, k + 1) - work_below(item, d, k);
  }
  return work;
}

void add_cells(const CellBox& box, std::int64_t work_of_a_cell, std::vector<std::uint64_t>& layers) {
  std::size_t first = 0;
  for (int d = 0; d < 3; first += box.size[d++])
    for (int k = 0; k < box.size[d]; ++k)
      layers[first + k] += std::uint64_t(work_of_a_cell * (box.cells() / box.size[d]));
}

CutPlane best_plane(const CellBox& box, const lbm::CutRoom& room, std::span<const std::uint64_t> layers,
                    double as_well) {
  std::array<CutPlane, 3> planes;
  std::size_t first = 0;
  for (int d = 0; d < 3; first += box.size[d++])
    planes[d] = best_across(d, box, room, layers.subspan(first, box.size[d]));
  const CutPlane* best =
      &*std::min_element(planes.begin(), planes.end(),
                         [](const CutPlane& a, const CutPlane& b) { return a.largest < b.largest; });
  const double bound = as_well * best->largest;
  for (const CutPlane& plane : planes)
    if (plane.largest <= bound && plane.face < best->face) best = &plane;
  return *best;
}

std::pair<WorkItem, WorkItem> parted(const WorkItem& item, int axis, int at) {
  WorkItem below = item, above = item;
  const int cells = std::clamp(at - item.box.lower[axis], 0, item.box.size[axis]);
  below.box.size[axis] = cells;
  below.work = work_below(item, axis, cells);
  above.box.lower[axis] += cells, above.box.size[axis] -= cells;
  above.work -= below.work;
  return {below, above};
}

}  // namespace silt::coupler
