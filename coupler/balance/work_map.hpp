#pragma once
// Where the work other than that of fluid cells is, by tiles, sparsely; and the work of levels of cells.
#include <cstdint>
#include <unordered_map>
#include <vector>

#include "lbm/blocks/domain.hpp"
#include "rigid/math/types.hpp"

namespace silt::coupler {

/// Work distributed evenly over a box of cells.
struct WorkItem {
  lbm::CellBox box;
  std::int64_t work;
};

class WorkMap {
 public:
  static constexpr int tile = 8;  // cells
  explicit WorkMap(const lbm::Domain&);

  /// Adds work at a point, wrapped along periodic axes and clamped into the domain along others.
  void add(const rigid::Vec3& x_W, std::int64_t work);
  /// Distributes work over the cells of a box, with positions outside the domain treated as above.
  void add(const rigid::BoundingBox& box_W, std::int64_t work);
  /// Adds work in the tile of a cell of the domain.
  void add(lbm::Int3 cell, std::int64_t work);
  /// Returns the tiles with work, in order.
  std::vector<WorkItem> items() const;

 private:
  int cell_along(int axis, double x) const;
  lbm::Int3 cells_, tiles_;
  bool periodic_[3];
  std::unordered_map<std::int64_t, std::int64_t> work_;  // by tile number, x fastest
};

/// Returns the work of one finest step in a leaf of known level, with `work_of_a_cell` for the update of a
/// cell in its own step: a cell of level l stands for 8^l finest cells and is updated in one of 2^l steps.
/// Exchange through the leaf's faces with cells of the next level is added; it costs more the shorter the
/// rows in a face are (lbm/method-fluid.md, "Levels").
std::int64_t work_of_leaf(const lbm::Domain& view, int leaf, std::int64_t work_of_a_cell);

}  // namespace silt::coupler
