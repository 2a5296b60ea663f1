#pragma once
// The kernel of narrow gaps, built once an instruction set: which cells lie in one.
#include "cpu/isa.hpp"

namespace silt::coupler {

/// The quadratic form r.K r / 2 of a surface's curvature K: how far it falls behind its tangent plane.
struct SurfaceFall {
  double xx, yy, zz, xy, yz, zx;  // of x^2, ..., of x y, ...
};

/// A gap seen from its middle, x along the axis of the lattice nearest to its normal. Cells.
struct GapOnLattice {
  double half_width;          // at the middle
  double normal[3];           // unit, from a to b; normal[0] is the largest, and positive
  double offset[3];           // centres of cells are whole numbers less these
  SurfaceFall a, b;           // of either surface
  double lowest;              // along the normal: its cells are above
  double extent_y, extent_z;  // its cells are no further from the middle
  int column;                 // at most so many cells along x, one after the other, are in it
};

/// The sum of cells_in_gap(), as each build offers it.
using SumOverGap = double(const GapOnLattice&);
SILT_BUILDS(SumOverGap sum_over_gap;)

}  // namespace silt::coupler
