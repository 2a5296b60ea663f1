#pragma once
// The loops that the fluid's benchmark measures production against, built once an instruction set like the
// hot kernels themselves (cpu/isa.hpp).
#include <cstddef>

#include "cpu/isa.hpp"
#include "lbm/blocks/lattice.hpp"

namespace silt::bench {

/// One way to walk through 19 arrays: so many at a time, of each so many cache lines in turn, each line asked
/// for so many lines ahead (0: left to the hardware).
struct AccessShape {
  int streams, lines, ahead;
};

/// The layout says where population i of a cell lies: beside the cell's others, or beside the next cell's
/// population i.
enum class Layout { array_of_structures, structure_of_arrays };
enum class Effort { straightforward, optimised };

/// Two arrays of populations with a ghost layer, `n` cells an edge: what the kernels of the paper's Table I
/// work on.
template <class T>
struct TwoArrays {
  int n;
  const T* from;  // n + 2 cells an edge, 19 populations each
  T* to;
  T omega;
  std::ptrdiff_t cells() const { return std::ptrdiff_t(n + 2) * (n + 2) * (n + 2); }
  std::ptrdiff_t cell(int x, int y, int z) const {
    return ((z + 1) * (n + 2) + y + 1) * std::ptrdiff_t(n + 2) + x + 1;
  }
};

/// The kernels of each build for populations of the type T, float or double.
template <class T>
struct BoundKernels {
  /// p = 0.999 p for 19 arrays of `cells` values, whole cache lines, `stride` apart: each read once and
  /// written once.
  void (*update_in_place)(T* data, std::ptrdiff_t stride, std::ptrdiff_t cells, AccessShape);
  /// Additions and multiplications that wait for nothing. Returns how many there were.
  double (*add_and_multiply)(T* result, int rounds);
};
/// Pulls into every cell what arrives there, and relaxes it with one time: bgk on deviations.
template <class T>
using PullAndRelax = void (*)(const TwoArrays<T>&, Layout, Effort);

SILT_BUILDS(template <class T> BoundKernels<T> bound_kernels();
            template <class T> PullAndRelax<T> pull_and_relax();)

/// Returns the kernels of the build that runs here.
template <class T>
BoundKernels<T> bound_kernels() {
  return SILT_CHOSEN(bound_kernels<T>)();
}
template <class T>
PullAndRelax<T> pull_and_relax() {
  return SILT_CHOSEN(pull_and_relax<T>)();
}

}  // namespace silt::bench
