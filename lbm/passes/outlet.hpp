#pragma once
// Computes the populations that outlets return (side_kinds.hpp), cell by cell, on any device.
#include <array>
#include <cstddef>
#include <cstdint>
#include <utility>

#include "cpu/device_code.hpp"
#include "cpu/prefetch.hpp"
#include "lbm/blocks/lattice.hpp"
#include "lbm/blocks/side_kinds.hpp"

namespace silt::lbm {

/// The properties of the collisions that outlets need.
struct AtOutlets {
  std::array<double, 3> force{};  // uniform acceleration
  double reversed = 1;            // method-fluid.md, equation 28a
};

struct OutletLink {
  std::uint32_t ghost, home;  // slots of the population that left, and of the one that returns
  std::int8_t x, y, z;        // its direction
  std::int8_t opposite;       // the opposite direction
};
/// A cell, by its Block::slot(0), and the range of its links.
struct OutletCell {
  std::uint32_t cell, first, last;
};

template <class T, class Lattice = D3Q19>
struct OutletCells {
  T* slots;
  std::ptrdiff_t left[Lattice::directions];  // slot of the population that left along i, relative to slot(0)
  double half_force[3];
  double reversed;  // AtOutlets
  bool fill;        // write ghost slots; else homes
  const OutletCell* cells;
  const OutletLink* links;
  std::size_t count;
};

/// `Outlet` is an outlet of side_kinds.hpp.
template <class T, class Lattice, class Outlet>
struct ReturnFromOutlet {
  OutletCells<T, Lattice> of;
  Outlet returned;

  static constexpr int ahead = 16;  // cells per cache line
  void fetch(std::int64_t k) const {
    for (int i = 1; i < Lattice::directions; ++i) prefetch_to_read(of.slots + of.left[i] + of.cells[k].cell);
  }
  SILT_DEVICE void operator()(std::int64_t k) const {
    const OutletCell at = of.cells[k];
    double u[3] = {of.half_force[0], of.half_force[1], of.half_force[2]};
    double sum = of.slots[of.left[0] + at.cell];
    const auto add = [&](auto i) {  // a constant: the factors -1, 0, 1 are known to the compiler
      constexpr Int3 v = Lattice::c[i];
      const double g = of.slots[of.left[i] + at.cell];
      sum += g;
      if constexpr (v.x != 0) u[0] += v.x * g;
      if constexpr (v.y != 0) u[1] += v.y * g;
      if constexpr (v.z != 0) u[2] += v.z * g;
    };
    [&]<int... i>(std::integer_sequence<int, i...>) {
      (add(std::integral_constant<int, i + 1>()), ...);
    }
    (std::make_integer_sequence<int, Lattice::directions - 1>());
    const double rest = 1.5 * (u[0] * u[0] + u[1] * u[1] + u[2] * u[2]);
    for (std::uint32_t n = at.first; n < at.last; ++n) {
      const OutletLink link = of.links[n];
      constexpr double straight = 2 * Lattice::w(1), diagonal = 2 * Lattice::w(Lattice::directions - 1);
      const double cu = link.x * u[0] + link.y * u[1] + link.z * u[2];
      const bool is_diagonal = link.x * link.x + link.y * link.y + link.z * link.z > 1;
      const T from = of.slots[of.fill ? link.home : link.ghost],
              back = of.slots[of.left[link.opposite] + at.cell];
      of.slots[of.fill ? link.ghost : link.home] =
          T(returned({from, back, is_diagonal ? diagonal : straight, cu, rest, sum, of.reversed}));
    }
  }
};

}  // namespace silt::lbm
