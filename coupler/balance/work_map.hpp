#pragma once
// The places of work besides that of the fluid's cells, by tiles, of which only those with any work are kept;
// and the work of cells of several levels.
#include <cstdint>
#include <unordered_map>
#include <vector>

#include "lbm/blocks/domain.hpp"
#include "rigid/math/types.hpp"

namespace silt::coupler {

/// Work that is spread evenly over a box of cells.
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
  /// Spreads work over the cells of a box, beyond the domain as well as above.
  void add(const rigid::BoundingBox& box_W, std::int64_t work);
  /// Adds work in the tile of a cell of the domain.
  void add(lbm::Int3 cell, std::int64_t work);
  /// The tiles with work, in order.
  std::vector<WorkItem> items() const;

 private:
  int cell_along(int axis, double x) const;
  lbm::Int3 cells_, tiles_;
  bool periodic_[3];
  std::unordered_map<std::int64_t, std::int64_t> work_;  // of tiles by their number, x fastest
};

/// Returns the work of one finest step in a leaf of known level, where the update of a cell in its own step
/// is so much work: a cell of level l stands for 8^l finest ones and is updated in one of 2^l steps. To it
/// comes what crosses the leaf's faces to cells of the next level, the more the shorter the rows are that lie
/// in a face (lbm/method-fluid.md, "Levels").
std::int64_t work_of_leaf(const lbm::Domain& view, int leaf, std::int64_t work_of_a_cell);

}  // namespace silt::coupler
