#pragma once
// Where work is besides that of the fluid's cells, which is the same everywhere: by tiles of 8 cells an edge,
// of which only those with any work are kept.
#include <cstdint>
#include <unordered_map>
#include <vector>

#include "lbm/domain.hpp"
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

}  // namespace silt::coupler
