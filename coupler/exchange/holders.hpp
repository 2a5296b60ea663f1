#pragma once
// Which ranks a body concerns: the one that owns it and those that hold a copy. A function of the block cuts
// alone, so that every rank comes to the same answer. Blocks form a grid, hence the blocks that a box meets,
// in any periodic image, are the product of one run of indices an axis: only these are looked at, however
// many blocks there are.
#include <vector>

#include "lbm/domain.hpp"
#include "rigid/shapes/bounding_box.hpp"

namespace silt::coupler {

class Holders {
 public:
  /// rim: cells by which blocks are grown on all sides.
  Holders(const lbm::Domain&, double rim);

  /// The block that contains x, and its rank: half-open boxes, x wrapped along periodic axes and clamped
  /// along others.
  int block_at(const rigid::Vec3& x_W) const;
  int rank_at(const rigid::Vec3& x_W) const { return domain_.blocks()[block_at(x_W)].rank; }
  /// Fills ranks, sorted, with those one of whose grown blocks meets the box, whatever its size.
  void ranks_of(const rigid::BoundingBox& box_W, std::vector<int>& ranks) const;

 private:
  struct Axis {
    std::vector<int> cuts;  // first cell of each block, then the end
    bool periodic;
    int blocks() const { return static_cast<int>(cuts.size()) - 1; }
    int block_at(double x) const;
  };
  struct Run {  // of block indices along an axis; goes round a periodic one
    int first, count;
  };
  Run met_by(const Axis&, double lower, double upper) const;

  const lbm::Domain& domain_;
  double rim_;
  std::array<Axis, 3> axes_;
};

}  // namespace silt::coupler
