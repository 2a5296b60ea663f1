#pragma once
// Steps of a fluid alone, its cells, and the conditions at its sides.
#include <array>

#include "lbm/blocks/domain.hpp"
#include "lbm/fluid.hpp"

namespace silt::lbm::testing {

// The sides of a domain that tests use most.
inline const SideCondition periodic{}, no_slip{SideKind::bounce}, slip{SideKind::free_slip};

inline SideCondition side_condition(SideKind kind, std::array<double, 3> v = {}, double rho = 0) {
  return {kind, v, rho};
}

inline std::array<SideCondition, 6> sides(SideCondition x, SideCondition y, SideCondition zl,
                                          SideCondition zh) {
  return {x, x, y, y, zl, zh};
}

template <class T>
void step(Fluid<T>& fluid) {
  fluid.stream_collide();
  fluid.exchange();
}

/// Calls f(block, local cell, global cell) for every cell of this rank.
template <class T, class F>
void for_all_cells(Fluid<T>& fluid, F&& f) {
  for (int b = 0; b < int(fluid.blocks().size()); ++b) {
    const CellBox& box = fluid.blocks()[b].box();
    for (int z = 0; z < box.size.z; ++z)
      for (int y = 0; y < box.size.y; ++y)
        for (int x = 0; x < box.size.x; ++x) f(b, Int3{x, y, z}, box.lower + Int3{x, y, z});
  }
}

}  // namespace silt::lbm::testing
