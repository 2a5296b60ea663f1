#pragma once
// Visits to the cells of this rank's blocks, x fastest.
#include "coupler/flow.hpp"
#include "coupler/mapping/for_cells.hpp"
#include "lbm/fluid.hpp"

namespace silt::coupler {

/// Calls visit(block, local cell, global cell) for every cell.
template <class Visit>
void for_each_cell(const Flow& flow, Visit&& visit) {
  for (int b = 0; b < flow.blocks(); ++b) {
    const lbm::CellBox& box = flow.block(b);
    for_cells({}, box.size, [&](lbm::Int3 x) { visit(b, x, box.lower + x); });
  }
}

/// Calls visit(global cell, moments) for every fluid cell.
template <class Visit>
void for_each_fluid_cell(const Flow& flow, Visit&& visit) {
  for (int b = 0; b < flow.blocks(); ++b) {
    const lbm::CellBox& box = flow.block(b);
    const CellBits& solid = flow.solid(b);
    lbm::MomentsByRow moments(flow, b, 0, box.size.x);
    for_cells({}, box.size, [&](lbm::Int3 x) {
      if (!solid.test(x)) visit(box.lower + x, moments(x));
    });
  }
}

}  // namespace silt::coupler
