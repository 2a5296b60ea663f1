#pragma once
// The loop over the cells of a box, x fastest.
#include "lbm/block.hpp"

namespace silt::coupler {

/// Calls visit(cell) for every cell with low <= cell < high.
template <class Visit>
void for_cells(lbm::Int3 low, lbm::Int3 high, Visit&& visit) {
  for (int z = low.z; z < high.z; ++z)
    for (int y = low.y; y < high.y; ++y)
      for (int x = low.x; x < high.x; ++x) visit(lbm::Int3{x, y, z});
}

}  // namespace silt::coupler
