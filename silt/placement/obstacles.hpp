#pragma once
// The obstacles of bodies to be placed: curved walls, given bodies, and bodies placed before.
#include <algorithm>
#include <array>
#include <cmath>
#include <span>
#include <vector>

#include "rigid/bodies/body_exchange.hpp"
#include "rigid/math/types.hpp"
#include "rigid/shapes/shape_fwd.hpp"
#include "silt/case/fill_room.hpp"
#include "silt/placement/given_bodies.hpp"

namespace silt {

// Finds boxes that may touch a box, by a grid over the domain of which only occupied cells use memory. For
// placing bodies, not for steps.

class NeighbourGrid {
 public:
  /// Makes cells at least `edge` wide, best about the size of most boxes.
  NeighbourGrid(const rigid::Extent& extent, double edge) : extent_(extent), heads_(64, nobody) {
    for (int d = 0; d < 3; ++d)
      count_[d] = static_cast<std::int64_t>(std::clamp(extent.size[d] / edge, 1.0, most_cells));
  }

  void insert(int index, const rigid::BoundingBox& box) {
    const Runs runs = runs_of(box);
    if (runs[0].length * runs[1].length * runs[2].length > many_cells)
      wide_.push_back(index);
    else
      for_cells(runs, [&](const Cell& cell) { insert(index, cell); });
  }

  /// Calls f(index) for all boxes that may touch the box, some more than once, until f returns false.
  template <class F>
  void visit(const rigid::BoundingBox& box, F&& f) const {
    bool going = true;
    for (std::size_t i = 0; going && i < wide_.size(); ++i) going = f(wide_[i]);
    for_cells(runs_of(box), [&](const Cell& cell) {
      for (int e = heads_[cell.hash() & (heads_.size() - 1)]; going && e != nobody; e = entries_[e].next)
        if (entries_[e].key == cell.key()) going = f(entries_[e].index);
    });
  }

 private:
  static constexpr int nobody = -1;
  static constexpr double most_cells = 1 << 21;    // along an axis, for keys of 64 bits
  static constexpr std::int64_t many_cells = 512;  // a box in more cells is examined by every visit
  struct Cell {
    std::uint64_t row, x;
    std::uint64_t key() const { return row << 21 | x; }
    // Cells along x have consecutive heads; rows are scattered.
    std::uint64_t hash() const { return x + row * 73856093; }
  };
  struct Entry {
    std::uint64_t key;
    int index, next;
  };
  struct Run {
    std::int64_t first, length;
  };
  using Runs = std::array<Run, 3>;

  Runs runs_of(const rigid::BoundingBox& box) const {
    Runs runs;
    for (int d = 0; d < 3; ++d) runs[d] = run(d, box.lower[d], box.upper[d]);
    return runs;
  }

  // Returns the cells of an axis that overlap [lower, upper]; beyond a wall those at the wall.
  Run run(int axis, double lower, double upper) const {
    const std::int64_t n = count_[axis];
    const double scale = static_cast<double>(n) / extent_.size[axis], last_cell = static_cast<double>(n - 1);
    const double low = std::floor(lower * scale), high = std::floor(upper * scale);
    if (extent_.periodic[axis]) {
      if (!(high - low < last_cell)) return {0, n};
      const double period = static_cast<double>(n) * std::floor(low / static_cast<double>(n));
      return {static_cast<std::int64_t>(low - period), static_cast<std::int64_t>(high - low) + 1};
    }
    const auto first = static_cast<std::int64_t>(std::clamp(low, 0., last_cell));
    const auto last = static_cast<std::int64_t>(std::clamp(high, 0., last_cell));
    return {first, last - first + 1};
  }

  // Calls f(cell).
  template <class F>
  void for_cells(const Runs& runs, F&& f) const {
    for (std::int64_t k = 0; k < runs[2].length; ++k)
      for (std::int64_t j = 0; j < runs[1].length; ++j) {
        const std::int64_t y = (runs[1].first + j) % count_[1], z = (runs[2].first + k) % count_[2];
        const auto row = static_cast<std::uint64_t>(y + count_[1] * z);
        for (std::int64_t i = 0, x = runs[0].first; i < runs[0].length; ++i) {
          f(Cell{row, static_cast<std::uint64_t>(x)});
          if (++x == count_[0]) x = 0;
        }
      }
  }

  int& head_of(const Cell& cell) { return heads_[cell.hash() & (heads_.size() - 1)]; }

  void insert(int index, const Cell& cell) {
    if (entries_.size() == heads_.size()) grow();
    int& head = head_of(cell);
    entries_.push_back({cell.key(), index, head});
    head = static_cast<int>(entries_.size()) - 1;
  }

  void grow() {
    heads_.assign(2 * heads_.size(), nobody);
    for (std::size_t e = 0; e < entries_.size(); ++e) {
      int& head = head_of({entries_[e].key >> 21, entries_[e].key & ((1 << 21) - 1)});
      entries_[e].next = head;
      head = static_cast<int>(e);
    }
  }

  rigid::Extent extent_;
  std::array<std::int64_t, 3> count_{};
  std::vector<int> heads_, wide_;  // heads: first entry per hash; a power of two of them
  std::vector<Entry> entries_;
};

/// Returns a lower bound of the overlap of two shapes in cells. Positive only if they overlap, so that no
/// valid scene is rejected; exact if one is a sphere; negative if none is found (two spheres: -distance).
double overlap_depth(const rigid::Shape& a, const rigid::Pose& pose_a, const rigid::Shape& b,
                     const rigid::Pose& pose_b);

/// Returns the largest overlap over the periodic images of b.
double overlap_depth(const rigid::Shape& a, const rigid::Pose& pose_a, const rigid::Shape& b,
                     const rigid::Pose& pose_b, const rigid::Extent&);

/// Returns the distance from a point to the nearest periodic image of a shape, negative inside.
double distance_to(const rigid::Shape&, const rigid::Pose&, const rigid::Vec3& x_W, const rigid::Extent&);

class Obstacles {
 public:
  /// Refers to the given bodies; `reach` is the largest distance of any query.
  Obstacles(const Case&, const rigid::Extent&, std::span<const GivenBody>, double reach);

  /// Begins balls of another radius; radii must decrease.
  void begin_balls(double radius, double gap);
  void add_ball(const rigid::Vec3& centre);
  /// Returns whether a ball with a gap around it touches no obstacle.
  bool is_free(const rigid::Vec3& centre, double radius, double gap) const;

 private:
  struct Balls {
    double radius;
    NeighbourGrid grid;
    std::vector<rigid::Vec3> centres;
  };

  const Case& setup_;
  const rigid::Extent extent_;
  const std::span<const GivenBody> given_;
  const CurvedWalls walls_;
  NeighbourGrid given_grid_;
  std::vector<Balls> balls_;
};

}  // namespace silt
