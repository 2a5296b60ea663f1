#pragma once
// The cells of the lattice in a narrow gap: how much of the flow there the lattice sees
// (coupler/forces/lubrication).
#include "rigid/bodies/lubrication.hpp"

namespace silt::coupler {

/// S of the gap: the sum of (1 - H)^2 over its cells of H < 1, over 2 pi R; 0 if it is wider than a cell.
/// Cells further than 8 from its middle along an axis are left out, where it is as large as that.
double cells_in_gap(const rigid::LubricatedGap&);

}  // namespace silt::coupler
