#pragma once
// Counts the cells in a narrow gap, which determine the resolved flow (coupler/forces/lubrication).
#include "cpu/isa.hpp"

namespace silt::rigid {
struct LubricatedGap;
}

namespace silt::coupler {

/// Returns S of the gap: the sum of (1 - H)^2 over its cells with a gap H < 1, over 2 pi R; 0 for gaps wider
/// than a cell. At most 8 cells from the middle along each axis are counted.
double cells_in_gap(const rigid::LubricatedGap&);

/// Half the curvature as a quadratic form: the distance of a surface behind its tangent plane is r.K r / 2.
struct SurfaceFall {
  double xx, yy, zz, xy, yz, zx;  // coefficients of x^2, ..., of x y, ...
};

/// A gap relative to its middle, with x along the lattice axis nearest to its normal. Lengths in cells.
struct GapOnLattice {
  double half_width;          // at the middle
  double normal[3];           // unit, from a to b; normal[0] is the largest component, positive
  double offset[3];           // cell centres are at integers minus this
  SurfaceFall a, b;           // of the two surfaces
  double lowest;              // lower bound of the cells' height along the normal
  double extent_y, extent_z;  // upper bounds of the cells' distance from the middle
  int column;                 // upper bound of the number of cells in a column along x
};

/// The sum in cells_in_gap(), one function for each build.
using SumOverGap = double(const GapOnLattice&);
SILT_BUILDS(SumOverGap sum_over_gap;)

}  // namespace silt::coupler
