#pragma once
// A tree of bounding boxes, to search many small items by point, line or box.
#include <algorithm>
#include <array>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "rigid/math/types.hpp"

namespace silt::rigid {

/// A balanced binary tree: each node halves its items across its longest side. Construction takes O(n log n)
/// and is deterministic. A node takes 32 bytes; boxes are rounded outward to single precision.
class BoxTree {
 public:
  struct Node {
    std::array<float, 3> lower, upper;
    std::uint32_t first;  // first item of a leaf; otherwise the first of two children
    std::uint32_t count;  // items of a leaf; 0 for an inner node

    /// Returns the square of the distance from a point to the box; 0 inside.
    double squared_distance(const Vec3& x) const {
      double square = 0;
      for (int d = 0; d < 3; ++d) {
        const double beyond = std::max({lower[d] - x[d], x[d] - upper[d], 0.0});
        square += beyond * beyond;
      }
      return square;
    }
    bool overlaps(const BoundingBox& box) const {
      for (int d = 0; d < 3; ++d)
        if (lower[d] > box.upper[d] || upper[d] < box.lower[d]) return false;
      return true;
    }
  };

  BoxTree() = default;
  /// Writes the order of the boxes along the leaves to `order`: item k of the tree is box order[k].
  BoxTree(std::span<const BoundingBox> boxes, std::vector<std::uint32_t>& order);

  /// Calls visit(item) for all items of the leaves whose own bound(node) and those of all nodes above are
  /// finite and at most `limit`, which visit may lower. Of two children that of the lower bound comes first.
  template <class Bound, class Visit>
  void search(const Bound& bound, const double& limit, Visit&& visit) const {
    if (nodes_.empty()) return;
    constexpr int depth = 64;  // twice the depth of a balanced tree of 2^32 items
    std::array<std::pair<double, std::uint32_t>, depth> stack;
    int top = 0;
    stack[top++] = {bound(nodes_[0]), 0};
    while (top > 0) {
      const auto [least, at] = stack[--top];
      if (!(least <= limit) || least == std::numeric_limits<double>::infinity()) continue;
      const Node& node = nodes_[at];
      for (std::uint32_t k = 0; k < node.count; ++k) visit(node.first + k);
      if (node.count > 0) continue;
      const double left = bound(nodes_[node.first]), right = bound(nodes_[node.first + 1]);
      const bool left_last = left <= right;
      stack[top++] = {left_last ? right : left, node.first + left_last};
      stack[top++] = {left_last ? left : right, node.first + !left_last};
    }
  }
  std::span<const Node> nodes() const { return nodes_; }

 private:
  void build(std::span<const BoundingBox> boxes, std::vector<std::uint32_t>& order, std::uint32_t node,
             std::uint32_t first, std::uint32_t end);
  std::vector<Node> nodes_;
};

}  // namespace silt::rigid
