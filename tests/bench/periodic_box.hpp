#pragma once
// The fluid alone in a periodic box, as several benchmarks time it.
#include <optional>

#include "lbm/fluid.hpp"

namespace silt::bench {

/// A fluid at rest, one block a rank.
template <class T>
lbm::Fluid<T> periodic_box(lbm::Int3 cells, const lbm::CollisionSpec& collision, int ranks = 1,
                           MPI_Comm comm = MPI_COMM_SELF) {
  return {lbm::Domain(cells, {}, std::nullopt, ranks), collision, comm};
}

template <class T>
void step(lbm::Fluid<T>& fluid, int steps = 1) {
  for (int t = 0; t < steps; ++t) {
    fluid.stream_collide();
    fluid.exchange();
  }
}

}  // namespace silt::bench
