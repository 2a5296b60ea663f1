#pragma once
// Outlets return populations for those that leave through them (side_kinds.hpp), a cell at a time, on any
// device.
#include <cstddef>
#include <cstdint>
#include <utility>

#include "cpu/device_code.hpp"
#include "cpu/prefetch.hpp"
#include "lbm/blocks/lattice.hpp"
#include "lbm/blocks/side_kinds.hpp"

namespace silt::lbm {

struct OutletLink {
  std::uint32_t ghost, home;  // slots: what left goes to one, what returns to the other
  std::int8_t x, y, z;        // its direction
  bool is_diagonal;
};
/// A cell (its Block::slot(0)) and its links.
struct OutletCell {
  std::uint32_t cell, first, last;
};

template <class T>
struct OutletCells {
  T* slots;
  std::ptrdiff_t left[D3Q19::directions];  // what left along i is so far from the cell's slot
  double half_force[3];
  bool fill;  // ghosts, else homes
  const OutletCell* cells;
  const OutletLink* links;
  std::size_t count;
};

/// `Outlet` is one of side_kinds.hpp.
template <class T, class Outlet>
struct ReturnFromOutlet {
  OutletCells<T> of;
  Outlet returned;

  static constexpr int ahead = 16;  // the cells of a cache line
  void fetch(std::int64_t k) const {
    for (int i = 1; i < D3Q19::directions; ++i) prefetch_to_read(of.slots + of.left[i] + of.cells[k].cell);
  }
  SILT_DEVICE void operator()(std::int64_t k) const {
    const OutletCell at = of.cells[k];
    double u[3] = {of.half_force[0], of.half_force[1], of.half_force[2]};
    const auto add = [&](auto i) {  // a constant: the factors -1, 0, 1 are known to the compiler
      constexpr Int3 v = D3Q19::c[i];
      const double g = of.slots[of.left[i] + at.cell];
      if constexpr (v.x != 0) u[0] += v.x * g;
      if constexpr (v.y != 0) u[1] += v.y * g;
      if constexpr (v.z != 0) u[2] += v.z * g;
    };
    [&]<int... i>(std::integer_sequence<int, i...>) {
      (add(std::integral_constant<int, i + 1>()), ...);
    }
    (std::make_integer_sequence<int, D3Q19::directions - 1>());
    const double rest = 1.5 * (u[0] * u[0] + u[1] * u[1] + u[2] * u[2]);
    for (std::uint32_t n = at.first; n < at.last; ++n) {
      const OutletLink link = of.links[n];
      constexpr double straight = 2 * D3Q19::w(1), diagonal = 2 * D3Q19::w(7);
      const double cu = link.x * u[0] + link.y * u[1] + link.z * u[2];
      const T from = of.slots[of.fill ? link.home : link.ghost];
      of.slots[of.fill ? link.ghost : link.home] =
          T(returned({from, link.is_diagonal ? diagonal : straight, cu, rest}));
    }
  }
};

}  // namespace silt::lbm
