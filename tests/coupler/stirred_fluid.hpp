#pragma once
// Fluid with a random velocity in every cell.
#include <array>
#include <random>

#include "lbm/fluid.hpp"
#include "tests/coupler/single_cells.hpp"

namespace silt::coupler::testing {

/// Gives every cell of this rank a velocity of its own, each component below `speed` (cells a step).
inline void stir(FluidFields& fields, double speed) {
  std::mt19937 random(1);
  std::uniform_real_distribution<double> u(-speed, speed);
  for_each_cell(fields, [&](int b, lbm::Int3 x, lbm::Int3) {
    std::array<double, 3> v;
    for (double& component : v) component = u(random);
    for (int i = 0; i < lbm::D3Q19::directions; ++i)
      set_arriving(fields, b, x, i, lbm::equilibrium(i, 0, v.data()));
  });
}

}  // namespace silt::coupler::testing
