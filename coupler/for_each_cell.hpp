#pragma once
// Every cell of this rank's blocks, x fastest.
#include "coupler/flow.hpp"

namespace silt::coupler {

/// Calls visit(block, local cell, global cell).
template <class Visit>
void for_each_cell(const Flow& flow, Visit&& visit) {
  for (int b = 0; b < flow.blocks(); ++b) {
    const lbm::CellBox& box = flow.block(b);
    for (int z = 0; z < box.size.z; ++z)
      for (int y = 0; y < box.size.y; ++y)
        for (int x = 0; x < box.size.x; ++x) visit(b, lbm::Int3{x, y, z}, box.lower + lbm::Int3{x, y, z});
  }
}

}  // namespace silt::coupler
