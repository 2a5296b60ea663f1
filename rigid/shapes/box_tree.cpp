#include "rigid/shapes/box_tree.hpp"

#include <cmath>
#include <numeric>

namespace silt::rigid {
namespace {

constexpr std::uint32_t leaf_items = 4;

float rounded_down(double x) {
  const float f = static_cast<float>(x);
  return f > x ? std::nextafterf(f, -std::numeric_limits<float>::infinity()) : f;
}

}  // namespace

BoxTree::BoxTree(std::span<const BoundingBox> boxes, std::vector<std::uint32_t>& order) {
  order.resize(boxes.size());
  std::iota(order.begin(), order.end(), 0u);
  if (boxes.empty()) return;
  nodes_.reserve(boxes.size() / leaf_items * 4 + 1);
  nodes_.emplace_back();
  build(boxes, order, 0, 0, static_cast<std::uint32_t>(boxes.size()));
}

void BoxTree::build(std::span<const BoundingBox> boxes, std::vector<std::uint32_t>& order, std::uint32_t node,
                    std::uint32_t first, std::uint32_t end) {
  BoundingBox all = BoundingBox::empty(), middles = BoundingBox::empty();
  for (std::uint32_t k = first; k < end; ++k) {
    const BoundingBox& box = boxes[order[k]];
    const Vec3 middle = 0.5 * (box.lower + box.upper);
    all.add(box), middles.add({middle, middle});
  }
  for (int d = 0; d < 3; ++d)
    nodes_[node].lower[d] = rounded_down(all.lower[d]), nodes_[node].upper[d] = -rounded_down(-all.upper[d]);
  if (end - first <= leaf_items) {
    nodes_[node].first = first, nodes_[node].count = end - first;
    return;
  }
  int axis;
  (middles.upper - middles.lower).maxCoeff(&axis);
  const auto begin = order.begin() + first;
  const std::uint32_t half = (end - first) / 2;
  std::nth_element(begin, begin + half, order.begin() + end, [&](std::uint32_t a, std::uint32_t b) {
    const double at_a = boxes[a].lower[axis] + boxes[a].upper[axis];
    const double at_b = boxes[b].lower[axis] + boxes[b].upper[axis];
    return at_a < at_b || (at_a == at_b && a < b);
  });
  std::sort(begin, begin + half), std::sort(begin + half, order.begin() + end);
  const auto child = static_cast<std::uint32_t>(nodes_.size());
  nodes_[node].first = child, nodes_[node].count = 0;
  nodes_.resize(nodes_.size() + 2);
  build(boxes, order, child, first, first + half);
  build(boxes, order, child + 1, first + half, end);
}

}  // namespace silt::rigid
