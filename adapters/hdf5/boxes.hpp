#pragma once
// Boxes of cells: what a rank holds of a global lattice.
#include <array>
#include <cstddef>

namespace silt::adapters {

/// CellBox holds the cells lower <= x < upper, in global cell coordinates. Boxes of all ranks must not
/// overlap.
struct CellBox {
  std::array<int, 3> lower, upper;

  std::size_t cells() const {
    std::size_t n = 1;
    for (int d = 0; d < 3; ++d) n *= upper[d] > lower[d] ? upper[d] - lower[d] : 0;
    return n;
  }
};

}  // namespace silt::adapters
