#pragma once
// Which part of a scene is solid.
#include "coupler/simulation.hpp"
#include "tests/world.hpp"

namespace silt::coupler::testing {

/// How many cells are in bodies and walls; collective.
inline double solid_cells(const Simulation& s) {
  const Flow& flow = *s.scene().flow;
  double count = 0;
  for (int b = 0; b < flow.blocks(); ++b) {
    const lbm::Int3 n = flow.block(b).size;
    for (int z = 0; z < n.z; ++z)
      for (int y = 0; y < n.y; ++y)
        for (int x = 0; x < n.x; ++x) count += !flow.is_fluid(b, {x, y, z});
  }
  return tests::sum_over_ranks(count);
}

}  // namespace silt::coupler::testing
