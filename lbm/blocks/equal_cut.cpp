#include "lbm/blocks/equal_cut.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>

namespace silt::lbm {

namespace {

/// Returns the number of leaves of this edge that fit along an axis, at least one.
std::int64_t fitting(int cells, int edge) {
  return std::max(1, cells / edge);
}

std::int64_t fitting(Int3 size, int edge) {
  return fitting(size.x, edge) * fitting(size.y, edge) * fitting(size.z, edge);
}

int least_edge(Int3 size, int leaves, int edge = usual_edge) {
  for (; edge >= 2; --edge)
    if (fitting(size, edge) >= leaves) return edge;
  throw std::invalid_argument("the domain of " + std::to_string(size.x) + " x " + std::to_string(size.y) +
                              " x " + std::to_string(size.z) + " cells cannot be cut into " +
                              std::to_string(leaves) +
                              " blocks of at least 2 cells an edge; use fewer ranks");
}

/// Appends the nodes of a part in preorder.
void cut_equally(const CellBox& box, int leaves, std::vector<Cut>& nodes) {
  if (leaves == 1) return;
  const CutRoom room = room_to_cut(box.size, leaves);
  int axis = -1;
  for (int d = 0; d < 3; ++d)
    if (!room.along(d, box.size).empty() &&
        (axis < 0 || box.size[d] / cost_of_face(d) > box.size[axis] / cost_of_face(axis)))
      axis = d;
  const CutRoom::Range range = room.along(axis, box.size);
  const int even = int((std::int64_t(box.size[axis]) * room.lower_leaves + leaves / 2) / leaves);
  const int lower = std::clamp(even, range.first, range.last);
  CellBox below = box, above = box;
  below.size[axis] = lower;
  above.lower[axis] += lower, above.size[axis] -= lower;
  nodes.push_back({axis, above.lower[axis], room.lower_leaves});
  cut_equally(below, room.lower_leaves, nodes);
  cut_equally(above, room.upper_leaves, nodes);
}

/// Returns the first cell of block k, where an axis of `cells` cells has `blocks` blocks.
int first_cell(int cells, int blocks, int k) {
  return int(std::int64_t(cells) * k / blocks);
}

/// Cuts a part of a grid of boxes: `count` boxes from `first` on.
void cut_grid(Int3 cells, Int3 boxes, Int3 first, Int3 count, std::vector<Cut>& nodes) {
  const auto begin = [&](int d) { return first_cell(cells[d], boxes[d], first[d]); };
  const auto length = [&](int d) { return first_cell(cells[d], boxes[d], first[d] + count[d]) - begin(d); };
  int axis = -1;
  for (int d = 0; d < 3; ++d)
    if (count[d] > 1 && (axis < 0 || length(d) / cost_of_face(d) > length(axis) / cost_of_face(axis)))
      axis = d;
  if (axis < 0) return;
  Int3 below = count, above = count, middle = first;
  below[axis] = count[axis] / 2;
  above[axis] -= below[axis];
  middle[axis] += below[axis];
  nodes.push_back({axis, first_cell(cells[axis], boxes[axis], middle[axis]), below.x * below.y * below.z});
  cut_grid(cells, boxes, first, below, nodes);
  cut_grid(cells, boxes, middle, above, nodes);
}

}  // namespace

CutRoom::Range CutRoom::along(int axis, Int3 size) const {
  const std::int64_t along = fitting(size[axis], edge);
  if (along < 2) return {1, 0};
  const std::int64_t layer = fitting(size, edge) / along;  // leaves per layer across the axis
  const auto layers = [&](int leaves) { return int((leaves + layer - 1) / layer); };
  return {layers(lower_leaves) * edge, size[axis] - layers(upper_leaves) * edge};
}

CutRoom room_to_cut(Int3 size, int leaves, int edge) {
  edge = least_edge(size, leaves, edge);
  for (int lower = leaves / 2; lower >= 1; --lower) {
    const CutRoom room{lower, leaves - lower, edge};
    for (int d = 0; d < 3; ++d)
      if (!room.along(d, size).empty()) return room;
  }
  throw std::logic_error("a part that has the room for its leaves cannot be cut");
}

double cost_of_face(int axis) {
  constexpr double cost[] = {2, 1.01, 1};  // slightly different, so that ties favour the last axis
  return cost[axis];
}

CutTree equal_cut(Int3 cells, int leaves) {
  std::vector<Cut> nodes;
  nodes.reserve(leaves - 1);
  least_edge(cells, leaves);
  cut_equally({{}, cells}, leaves, nodes);
  return {cells, std::move(nodes)};
}

CutTree grid_cut(Int3 cells, Int3 leaf_cells) {
  Int3 boxes;
  for (int d = 0; d < 3; ++d) boxes[d] = std::max(1, (cells[d] + leaf_cells[d] - 1) / leaf_cells[d]);
  std::vector<Cut> nodes;
  cut_grid(cells, boxes, {}, boxes, nodes);
  return {cells, std::move(nodes)};
}

}  // namespace silt::lbm
