#pragma once
// The order of the dense pass where something follows close behind it: strips of rows, and plane after plane
// within a strip, so that three planes of a strip stay in cache. A part is a strip of one
// plane.
//
//     z |  3 | 7 |     parts of a block of 4 planes and two strips; once 2 is done, the cells of 1 whose
//       |  2 | 6 |     neighbours are all in the strip have nothing left to wait for
//       |  1 | 5 |
//       |  0 | 4 |
//        --------- y
#include <algorithm>
#include <cstddef>

#include "lbm/stream_collide.hpp"

namespace silt::lbm {

class Sweep {
 public:
  /// Bytes of populations that a strip may have in three planes: more than the second-level cache of most
  /// machines, since short strips cost the dense pass more than they save.
  static constexpr std::size_t cached_bytes = 2560 << 10;

  Sweep() = default;
  Sweep(Int3 size, std::size_t bytes_of_a_population) : ny_(size.y), nz_(size.z) {
    const std::size_t row = std::size_t(size.x) * directions * bytes_of_a_population;
    const int fitting = std::max(8, int(cached_bytes / (3 * row)));
    const int strips = std::max(1, (ny_ + fitting / 2) / fitting);
    rows_ = (ny_ + strips - 1) / strips;
  }
  int parts() const { return (ny_ + rows_ - 1) / rows_ * nz_; }
  int part_of(int y, int z) const { return y / rows_ * nz_ + z; }
  RowRange rows_of(int part) const {
    const int strip = part / nz_, z = part % nz_;
    return {strip * rows_, std::min((strip + 1) * rows_, ny_), z, z + 1};
  }
  /// First row beyond those whose cells, with all their neighbours, have collided after the same part as (y,
  /// z) has.
  int next_row(int y) const { return ((y + 1) / rows_ + 1) * rows_ - 1; }
  /// The part after which a cell of the inside and all its neighbours have collided.
  int ready(int y, int z) const { return part_of(y + 1, z + 1); }

 private:
  int ny_ = 1, nz_ = 1, rows_ = 1;
};

}  // namespace silt::lbm
