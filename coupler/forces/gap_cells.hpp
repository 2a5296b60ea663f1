#pragma once
// The cells of the lattice in a narrow gap: how much of the flow there the lattice sees
// (coupler/forces/lubrication).
#include "cpu/isa.hpp"

namespace silt::rigid {
struct LubricatedGap;
}

namespace silt::coupler {

/// S of the gap: the sum of (1 - H)^2 over its cells of H < 1, over 2 pi R; 0 if it is wider than a cell.
/// Cells further than 8 from its middle along an axis are left out, where it is as large as that.
double cells_in_gap(const rigid::LubricatedGap&);

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
