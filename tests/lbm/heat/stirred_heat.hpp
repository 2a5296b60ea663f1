#pragma once
// A fluid with a temperature, without bodies.
#include "lbm/heat/temperature.hpp"
#include "tests/lbm/fluid_cells.hpp"

namespace silt::lbm::testing {

using Velocity = std::array<double, 3>;

/// Sets both from functions of the global cell: t(cell) and u(cell).
template <class T, class Heat, class Stream>
void set(Fluid<T>& fluid, Temperature<T>& heat, Heat&& t, Stream&& u) {
  for_all_cells(fluid, [&](int b, Int3 x, Int3 g) {
    set_equilibrium(fluid, b, x, 0, u(g));
    heat.set(b, x, t(g), u(g));
  });
}

}  // namespace silt::lbm::testing
