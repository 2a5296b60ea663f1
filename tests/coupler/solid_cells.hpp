#pragma once
// Which part of a scene is solid.
#include "coupler/simulation.hpp"
#include "tests/world.hpp"

namespace silt::coupler::testing {

/// How many cells are in bodies and walls; collective.
inline double solid_cells(const Simulation& s) {
  const FluidFields& fields = s.scene().flow->fields();
  double count = 0;
  for (int b = 0; b < fields.blocks(); ++b) {
    const lbm::Int3 n = fields.block(b).size;
    for (int z = 0; z < n.z; ++z)
      for (int y = 0; y < n.y; ++y)
        for (int x = 0; x < n.x; ++x) count += !fields.is_fluid(b, {x, y, z});
  }
  return tests::sum_over_ranks(count);
}

}  // namespace silt::coupler::testing
