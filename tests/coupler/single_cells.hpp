#pragma once
// The fields of the fluid cell by cell.
#include "coupler/fluid_fields.hpp"

namespace silt::coupler::testing {

/// Calls visit(block, local cell, global cell) for every cell of this rank, x fastest.
template <class Visit>
void for_each_cell(const FluidFields& fields, Visit&& visit) {
  for (int b = 0; b < fields.blocks(); ++b) {
    const lbm::CellBox& box = fields.block(b);
    for_cells({}, box.size, [&](lbm::Int3 x) { visit(b, x, box.lower + x); });
  }
}

inline double arriving(const FluidFields& fields, int b, lbm::Int3 x, int i) {
  double g = 0;
  fields.read(b, {x, {1, 1, 1}}, i, &g);
  return g;
}
inline void set_arriving(FluidFields& fields, int b, lbm::Int3 x, int i, double g) {
  fields.write(b, {x, {1, 1, 1}}, i, &g);
}
inline rigid::Vec3 velocity(const FluidFields& fields, int b, lbm::Int3 x) {
  lbm::MomentArrays moments;
  fields.moments(b, {x, {1, 1, 1}}, moments);
  return rigid::Vec3(fields.velocity(moments[0]).data());
}

}  // namespace silt::coupler::testing
