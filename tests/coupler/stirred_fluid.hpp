#pragma once
// Fluid with a random velocity in every cell.
#include <array>
#include <random>

#include "coupler/for_each_cell.hpp"

namespace silt::coupler::testing {

/// Gives every cell of this rank a velocity of its own, each component below `speed` (cells a step).
inline void stir(Flow& flow, double speed) {
  std::mt19937 random(1);
  std::uniform_real_distribution<double> u(-speed, speed);
  for_each_cell(flow, [&](int b, lbm::Int3 x, lbm::Int3) {
    std::array<double, 3> v;
    for (double& component : v) component = u(random);
    flow.set_equilibrium(b, x, 0, v);
  });
}

}  // namespace silt::coupler::testing
