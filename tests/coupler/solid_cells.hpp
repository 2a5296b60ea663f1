#pragma once
// Which part of a scene is solid.
#include "silt/simulation.hpp"
#include "tests/coupler/single_cells.hpp"
#include "tests/world.hpp"

namespace silt::coupler::testing {

/// Counts the cells that are in bodies and walls; collective.
inline double solid_cells(const Simulation& s) {
  const FluidFields& fields = s.scene().flow->fields();
  double count = 0;
  for_each_cell(fields, [&](int b, lbm::Int3 x, lbm::Int3) { count += !fields.is_fluid(b, x); });
  return tests::sum_over_ranks(count);
}

}  // namespace silt::coupler::testing
