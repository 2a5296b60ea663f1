#pragma once
// Which ranks a body concerns: the one that owns it and those that hold a copy. A function of the cuts alone,
// so that every rank comes to the same answer, found by descending their tree: only the blocks that a box
// meets, in any periodic image, are looked at, however many there are.
#include <vector>

#include "lbm/domain.hpp"
#include "rigid/shapes/bounding_box.hpp"

namespace silt::coupler {

class Holders {
 public:
  /// rim: cells by which blocks are grown on all sides.
  Holders(const lbm::Domain& domain, double rim) : domain_(domain), rim_(rim) {}

  /// The block that contains x, and its rank: half-open boxes, x wrapped along periodic axes and clamped
  /// along others.
  int block_at(const rigid::Vec3& x_W) const { return domain_.tree().leaf_at(cell_at(x_W)).index; }
  int rank_at(const rigid::Vec3& x_W) const { return domain_.rank_of(block_at(x_W)); }
  /// Fills ranks, sorted, with those one of whose grown blocks meets the box, whatever its size.
  void ranks_of(const rigid::BoundingBox& box_W, std::vector<int>& ranks) const;

 private:
  lbm::Int3 cell_at(const rigid::Vec3& x_W) const;
  /// The cells that an interval meets; beyond a wall the last ones before it.
  lbm::CellRun met_by(int axis, double lower, double upper) const;

  const lbm::Domain& domain_;
  double rim_;
};

}  // namespace silt::coupler
