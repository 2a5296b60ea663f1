#pragma once
// The order of the dense pass. The shell collides first, i.e. the rows at faces beyond which another rank is,
// so that messages to that rank travel during the rest. Strips of rows follow, plane after plane within a
// strip, so that three planes of a strip stay in cache. A part is one plane of a strip.
//
//     z |  3 | 7 |     parts of a block of 4 planes and two strips, without a shell; after part 2 the cells
//       |  2 | 6 |     of part 1 whose neighbours are all in the strip are complete
//       |  1 | 5 |
//       |  0 | 4 |
//        --------- y
#include <algorithm>
#include <cstddef>
#include <vector>

#include "lbm/blocks/block.hpp"

namespace silt::lbm {

/// Faces of a block, low and high, whose rows form the shell; none across x, as every row touches those.
struct ShellFaces {
  bool y[2] = {}, z[2] = {};
};

class PassOrder {
 public:
  /// The largest size of the populations of three planes of a strip: more than the second-level cache of most
  /// machines, since short strips cost the dense pass more than they save.
  static constexpr std::size_t cached_bytes = 2560 << 10;

  PassOrder() = default;
  PassOrder(Int3 size, std::size_t bytes_of_a_population, ShellFaces shell = {})
      : all_{0, size.y, 0, size.z} {
    const std::size_t row = std::size_t(size.x) * D3Q19::directions * bytes_of_a_population;
    const int fitting = std::max(8, int(cached_bytes / (3 * row)));
    const int strips = std::max(1, (size.y + fitting / 2) / fitting);
    rows_ = (size.y + strips - 1) / strips;
    const auto end = [](bool low, bool high, int n) { return std::max(n - high, int(low)); };
    inner_ = {shell.y[0], end(shell.y[0], shell.y[1], size.y), shell.z[0],
              end(shell.z[0], shell.z[1], size.z)};
  }

  bool in_shell(int y, int z) const {
    return y < inner_.y0 || y >= inner_.y1 || z < inner_.z0 || z >= inner_.z1;
  }
  std::vector<RowRange> shell() const {
    return {{all_.y0, all_.y1, all_.z0, inner_.z0},
            {all_.y0, all_.y1, inner_.z1, all_.z1},
            {all_.y0, inner_.y0, inner_.z0, inner_.z1},
            {inner_.y1, all_.y1, inner_.z0, inner_.z1}};
  }
  RowRange inner() const { return inner_; }
  int parts() const { return (all_.y1 + rows_ - 1) / rows_ * all_.z1; }
  /// Returns the part of a row; -1 for a row of the shell, which comes before all parts.
  int part_of(int y, int z) const { return in_shell(y, z) ? -1 : y / rows_ * all_.z1 + z; }
  /// Returns the rows of a part; an empty range if all of it is in the shell.
  RowRange rows_of(int part) const {
    const int strip = part / all_.z1, z = part % all_.z1;
    const int y0 = std::max(strip * rows_, inner_.y0), y1 = std::min((strip + 1) * rows_, inner_.y1);
    return {y0, in_shell(y0, z) ? y0 : y1, z, z + 1};
  }
  /// Returns the first row above y for which ready() returns a later part, faces of the block aside.
  int next_row(int y, int reach) const { return ((y + reach) / rows_ + 1) * rows_ - reach; }
  /// Returns the part after which a cell inside by more than `reach` and all within `reach` have collided.
  int ready(int y, int z, int reach) const {
    return part_of(std::min(y + reach, inner_.y1 - 1), std::min(z + reach, inner_.z1 - 1));
  }

 private:
  int rows_ = 1;  // of a strip
  RowRange all_{0, 1, 0, 1}, inner_ = all_;
};

}  // namespace silt::lbm
