#pragma once
// Steps of a fluid alone, its cells, and the conditions at its sides.
#include <mpi.h>

#include <array>
#include <bit>
#include <cstdint>

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

template <class T>
void set_equilibrium(Fluid<T>& fluid, int b, Int3 x, double rho, const std::array<double, 3>& u) {
  for (int i = 0; i < D3Q19::directions; ++i) fluid.arriving(b, x, i) = T(equilibrium(i, rho, u.data()));
}

/// Calls f(block, local cell, global cell) for every cell of this rank.
template <class T, class F>
void for_all_cells(Fluid<T>& fluid, F&& f) {
  for (int b = 0; b < int(fluid.blocks().size()); ++b) {
    const CellBox& box = fluid.blocks()[b].box();
    for_cells({}, box.size, [&](Int3 x) { f(b, x, box.lower + x); });
  }
}

/// A hash without order: each value's bits are mixed with where it is; of all ranks.
class Fingerprint {
 public:
  void add(double value, const std::array<double, 3>& at, int direction = 0) {
    std::uint64_t h = std::bit_cast<std::uint64_t>(value);
    h ^= std::bit_cast<std::uint64_t>((at[2] * 1009 + at[1]) * 1009 + at[0]) * 19 +
         direction * 0x9E3779B97F4A7C15u;
    h ^= h >> 31, h *= 0xBF58476D1CE4E5B9u, h ^= h >> 29;
    sum_ += h;
  }
  void add(double value, Int3 at, int direction) {
    add(value, std::array{at.x + 0.5, at.y + 0.5, at.z + 0.5}, direction);
  }
  std::uint64_t over(MPI_Comm comm) const {
    std::uint64_t all = 0;
    MPI_Allreduce(&sum_, &all, 1, MPI_UINT64_T, MPI_SUM, comm);
    return all;
  }

 private:
  std::uint64_t sum_ = 0;
};

}  // namespace silt::lbm::testing
