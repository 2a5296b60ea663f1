#pragma once
// Cuts faces of boxes of coarse cells into rectangles whose cells have the same leaves of the tree of cuts
// around them. All ranks that know these leaves find the same rectangles in the same order.
#include <vector>

#include "lbm/exchange/ghost_home.hpp"

namespace silt::lbm {

/// The levels around a coarse cell, and along each axis the number of cells from it on that have the same
/// leaves around them.
struct Surroundings {
  bool any_fine = false, any_outside = false, any_far = false;
  bool fine[3][3][3] = {};  // by z, y, x
  Int3 alike{1 << 30, 1 << 30, 1 << 30};

  /// Returns whether a population that moves along j may enter fine cells.
  template <class Lattice>
  bool may_meet(int j) const {
    bool found = any_outside;
    for (int k = 1; k < 8; ++k) {
      const Int3 v = corner(k);
      found |= fine[1 + v.z * Lattice::c[j].z][1 + v.y * Lattice::c[j].y][1 + v.x * Lattice::c[j].x];
    }
    return found;
  }
};

class BorderSurroundings {
 public:
  BorderSurroundings(const Domain& fine, const Domain& coarse) : fine_(fine), coarse_(coarse) {}
  Surroundings around(Int3 coarse_cell);

 private:
  const Domain &fine_, &coarse_;
  BlockPlace recent_[3][3][3] = {};  // leaves of the last cell's neighbours: often the same again
};

/// Cells from `first` on, in rows along one axis, one after another along another.
struct BorderPiece {
  Int3 first;
  int length, rows;
  Surroundings around;
};

/// Returns the pieces of a face beside fine cells, except those that touch leaves that this rank does not
/// know, by their places along `outer`, then along `axis`.
std::vector<BorderPiece> alike_pieces(BorderSurroundings&, const CellBox& face, int axis, int outer);

}  // namespace silt::lbm
