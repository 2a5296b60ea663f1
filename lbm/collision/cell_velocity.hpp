#pragma once
// Velocity of a vector of cells before its collision. Only for *_kernel.cpp files (SILT_BUILD).
#include "cpu/device_code.hpp"
#include "lbm/blocks/lattice.hpp"
#include "lbm/collision/collision_model.hpp"

namespace silt::lbm::SILT_BUILD {

/// Sets the velocity from each pair's difference (along less against its first direction) and half the force.
template <bool source, class V, class Rates>
[[gnu::always_inline]] SILT_DEVICE inline void set_velocity(const V (&difference)[D3Q19::pairs],
                                                            const Rates& r, V& ux, V& uy, V& uz) {
  const V* const d = difference;
  ux = d[0] + ((d[3] + d[4]) + (d[5] + d[6]));
  uy = d[1] + ((d[3] - d[4]) + (d[7] + d[8]));
  uz = d[2] + ((d[5] - d[6]) + (d[7] - d[8]));
  if constexpr (source) {
    ux += r.half_force[0];
    uy += r.half_force[1];
    uz += r.half_force[2];
  }
}

}  // namespace silt::lbm::SILT_BUILD
