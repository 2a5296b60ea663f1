#pragma once
// A uniform grid of buckets over the domain that finds which boxes may touch a box. Used before step 1 only:
// to fill the domain with bodies and to look for overlaps.
#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "rigid/bodies/body_exchange.hpp"

namespace silt::coupler {

class NeighbourGrid {
 public:
  /// Makes buckets at least `edge` wide, and no more of them than `most_buckets`.
  NeighbourGrid(const rigid::Extent& extent, double edge) : extent_(extent) {
    constexpr double most_buckets = 1 << 20;  // 24 MB
    const double volume = extent.size.prod();
    edge = std::max(edge, std::cbrt(volume / most_buckets));
    for (int d = 0; d < 3; ++d) count_[d] = std::max(1, static_cast<int>(extent.size[d] / edge));
    buckets_.resize(static_cast<std::size_t>(count_[0]) * count_[1] * count_[2]);
  }

  void insert(int index, const rigid::Vec3& lower, const rigid::Vec3& upper) {
    for_buckets(lower, upper, [&](std::size_t bucket) { buckets_[bucket].push_back(index); });
  }

  /// Calls f(index) for all boxes that may touch [lower, upper], for some more than once, until f returns
  /// false.
  template <class F>
  void visit(const rigid::Vec3& lower, const rigid::Vec3& upper, F&& f) const {
    bool going = true;
    for_buckets(lower, upper, [&](std::size_t bucket) {
      for (std::size_t i = 0; going && i < buckets_[bucket].size(); ++i) going = f(buckets_[bucket][i]);
    });
  }

 private:
  struct Run {
    int first, length;
  };

  // The buckets of an axis that [lower, upper] meets; outside a wall those at the wall.
  Run run(int axis, double lower, double upper) const {
    const int n = count_[axis];
    const double scale = n / extent_.size[axis];
    const double low = std::floor(lower * scale), high = std::floor(upper * scale);
    if (extent_.periodic[axis]) {
      if (!(high - low + 1 < n)) return {0, n};
      const int first = static_cast<int>(low - n * std::floor(low / n));
      return {first, static_cast<int>(high - low) + 1};
    }
    const int first = static_cast<int>(std::clamp(low, 0., n - 1.));
    const int last = static_cast<int>(std::clamp(high, 0., n - 1.));
    return {first, last - first + 1};
  }

  template <class F>
  void for_buckets(const rigid::Vec3& lower, const rigid::Vec3& upper, F&& f) const {
    std::array<Run, 3> runs;
    for (int d = 0; d < 3; ++d) runs[d] = run(d, lower[d], upper[d]);
    for (int k = 0; k < runs[2].length; ++k)
      for (int j = 0; j < runs[1].length; ++j)
        for (int i = 0; i < runs[0].length; ++i) {
          const std::size_t x = (runs[0].first + i) % count_[0], y = (runs[1].first + j) % count_[1],
                            z = (runs[2].first + k) % count_[2];
          f((z * count_[1] + y) * count_[0] + x);
        }
  }

  rigid::Extent extent_;
  std::array<int, 3> count_{};
  std::vector<std::vector<int>> buckets_;
};

/// Returns the shortest of the displacements between a point and the periodic images of another.
inline rigid::Vec3 nearest_image(rigid::Vec3 d, const rigid::Extent& extent) {
  for (int axis = 0; axis < 3; ++axis)
    if (extent.periodic[axis]) d[axis] -= extent.size[axis] * std::round(d[axis] / extent.size[axis]);
  return d;
}

}  // namespace silt::coupler
