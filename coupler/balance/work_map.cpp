#include "coupler/balance/work_map.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace silt::coupler {

using lbm::Int3;

WorkMap::WorkMap(const lbm::Domain& domain) : cells_(domain.cells()) {
  for (int d = 0; d < 3; ++d) {
    tiles_[d] = (cells_[d] + tile - 1) / tile;
    periodic_[d] = domain.periodic(d);
  }
}

void WorkMap::add(Int3 cell, std::int64_t work) {
  const std::int64_t x = cell.x / tile, y = cell.y / tile, z = cell.z / tile;
  if (work != 0) work_[(z * tiles_.y + y) * tiles_.x + x] += work;
}

int WorkMap::cell_along(int axis, double x) const {
  const int n = cells_[axis];
  if (periodic_[axis]) x -= std::floor(x / n) * n;
  return !(x >= 0) ? 0 : x >= n ? n - 1 : int(x);
}

void WorkMap::add(const rigid::Vec3& x, std::int64_t work) {
  add(Int3{cell_along(0, x[0]), cell_along(1, x[1]), cell_along(2, x[2])}, work);
}

/// Represents the box by points half a tile apart, at most most_points along an edge, each with its share.
void WorkMap::add(const rigid::BoundingBox& box, std::int64_t work) {
  constexpr double most_points = 32;
  std::array<int, 3> points;
  rigid::Vec3 step;
  for (int d = 0; d < 3; ++d) {
    const double length = std::min(box.upper[d] - box.lower[d], double(cells_[d]));
    points[d] = int(std::clamp(std::ceil(2 * length / tile), 1., most_points));
    step[d] = length / points[d];
  }
  const std::int64_t all = std::int64_t(points[0]) * points[1] * points[2];
  std::int64_t n = 0;
  for (int z = 0; z < points[2]; ++z)
    for (int y = 0; y < points[1]; ++y)
      for (int x = 0; x < points[0]; ++x, ++n)
        add(rigid::Vec3(box.lower + step.cwiseProduct(rigid::Vec3(x + 0.5, y + 0.5, z + 0.5))),
            work / all + (n < work % all));
}

std::vector<WorkItem> WorkMap::items() const {
  std::vector<std::pair<std::int64_t, std::int64_t>> sorted(work_.begin(), work_.end());
  std::sort(sorted.begin(), sorted.end());
  std::vector<WorkItem> items;
  for (const auto& [number, work] : sorted) {
    const Int3 at{int(number % tiles_.x), int(number / tiles_.x % tiles_.y),
                  int(number / tiles_.x / tiles_.y)};
    lbm::CellBox box;
    for (int d = 0; d < 3; ++d) {
      box.lower[d] = tile * at[d];
      box.size[d] = std::min(int(tile), cells_[d] - box.lower[d]);
    }
    items.push_back({box, work});
  }
  return items;
}

namespace {
/// The cost, in updates of fine cells, of a coarse cell at a face across each axis in each of the two fine
/// steps; measured on one core with fifty regions of 28 cells an edge.
constexpr std::array<std::int64_t, 3> updates_at_a_face = {60, 30, 15};
}  // namespace

std::int64_t work_of_leaf(const lbm::Domain& view, int leaf, std::int64_t work_of_a_cell) {
  const int level = view.tree().kinds()[leaf].level;
  const lbm::Domain coarser(view.tree(), view.sides(), view.ranks(), level + 1);
  const lbm::CellBox box = coarser.block(leaf).box;
  std::int64_t updates = view.tree().leaf(leaf).box.cells() >> 3 * level;
  for (int axis = 0; axis < 3; ++axis)
    for (const bool high : {false, true}) {
      lbm::CellBox beyond = box;
      beyond.lower[axis] += high ? box.size[axis] : -1;
      beyond.size[axis] = 1;
      beyond.lower = coarser.wrapped(beyond.lower);
      if (!coarser.inside(beyond.lower)) continue;
      coarser.for_blocks_meeting(beyond, [&](const lbm::BlockPlace& there) {
        updates += updates_at_a_face[axis] * lbm::overlap(there.box, beyond).cells();
      });
    }
  return (work_of_a_cell * updates) >> level;
}

}  // namespace silt::coupler
