#pragma once
// Moments of the populations that arrive at a cell or at the cells of a row, and their totals over cells.
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <vector>

#include "cpu/isa.hpp"
#include "lbm/blocks/block.hpp"

namespace silt::lbm {

/// Moments of the deviations from density 1 at rest, lattice units.
struct Moments {
  double density_deviation = 0;
  double momentum[3] = {};  // sum c g, without the half force
  double flux[6] = {};      // sum c c g: xx yy zz xy xz yz
};

/// Returns the velocity of a cell in lattice units: momentum plus half the body force (density 1).
SILT_DEVICE inline std::array<double, 3> velocity_of(const Moments& m, const std::array<double, 3>& force) {
  return {m.momentum[0] + 0.5 * force[0], m.momentum[1] + 0.5 * force[1], m.momentum[2] + 0.5 * force[2]};
}

/// Returns the equilibrium of weight w_i along c_i (method.md, equation 2), lattice units.
SILT_DEVICE inline double equilibrium(Int3 c, double weight, double rho, const double (&j)[3]) {
  const double cj = c.x * j[0] + c.y * j[1] + c.z * j[2];
  return weight * (rho + 3 * cj + 4.5 * cj * cj - 1.5 * (j[0] * j[0] + j[1] * j[1] + j[2] * j[2]));
}
inline double equilibrium(int i, double density_deviation, const double momentum[3]) {
  return equilibrium(D3Q19::c[i], D3Q19::w(i), density_deviation, {momentum[0], momentum[1], momentum[2]});
}

/// The quantum of sums of mass, lattice units.
inline constexpr double mass_quantum = 0x1p-40;
SILT_DEVICE inline std::int64_t mass_quanta(const Moments& m) {
  return std::llrint(m.density_deviation / mass_quantum);
}

/// Sums over cells in whole quanta, independent of the order of the cells, and extremes: mass (of the density
/// deviations), its square, momentum (without the half force) and kinetic energy (with it), in lattice units.
struct CellTotals {
  static constexpr double momentum_quantum = 0x1p-48, energy_quantum = 0x1p-47, energy_rest_quantum = 0x1p-96;
  static constexpr double square_quantum = 0x1p-46;
  static constexpr int most_cells = 1 << 14;  // per call: their sums fit 64 bits
  static constexpr double no_flow_is_so_fast = 1, no_fluid_is_so_dense = 2;

  std::int64_t mass = 0, mass_square = 0, momentum[3] = {};
  std::int64_t energy = 0, energy_rest = 0;  // energy_rest: the remainder of energy, in finer quanta
  double speed_squared = -1;                 // the maximum
  double least_deviation = std::numeric_limits<double>::max(), most_deviation = -least_deviation;
  /// The extremes of the temperature that the fluid carries, less that of reference. The largest is infinite
  /// if a cell's is not a number.
  double least_temperature = std::numeric_limits<double>::max(), most_temperature = -least_temperature;
  bool sound = true;  // false: a cell is not a number or beyond the limits, and the sums are invalid
};

/// `cells` cells of a block along x from `first` on, and as many in each of the `rows` rows after.
struct LocalRows {
  Int3 first;
  int cells = 0, rows = 1;
};
/// `cells` cells along x, in `rows` rows that are `stride` elements apart in memory.
struct CellRows {
  int cells, rows = 1;
  std::ptrdiff_t stride = 0;
};

/// The kernels for rows of cells (moments_kernel.cpp); g[i][k] is population i that arrives at the k-th cell.
template <class T>
struct MomentsKernels {
  /// Writes moment j of the k-th cell to moments[j * stride + k], in the order of MomentArrays.
  void (*sum)(const T* const (&g)[D3Q19::directions], std::ptrdiff_t cells, std::ptrdiff_t stride,
              double* moments);
  /// Returns the totals of cells under a body force, in the precision of the populations for each cell.
  CellTotals (*total)(const T* const (&g)[D3Q19::directions], const CellRows&,
                      const std::array<double, 3>& force);
};
SILT_BUILDS(template <class T> MomentsKernels<T> moments_kernels();)
template <class T>
const MomentsKernels<T>& moments_kernels() {
  static const MomentsKernels<T> kernels = SILT_CHOSEN(moments_kernels<T>)();
  return kernels;
}

/// The moments of the cells of a box, x fastest, one array per moment so that vectors of cells can be summed.
class MomentArrays {
 public:
  Moments operator[](std::int64_t cell) const;
  void resize(std::int64_t cells) {
    cells_ = cells;
    values_.resize(std::size_t(count * cells));
  }
  /// Sets the moments of cells from index `first` on; g[i][k] is population i that arrives at the k-th.
  template <class T>
  void sum(const T* const (&g)[D3Q19::directions], std::int64_t first, int cells) {
    moments_kernels<T>().sum(g, cells, cells_, values_.data() + first);
  }

 private:
  static constexpr int count = 10;
  std::vector<double> values_;  // one array per moment
  std::int64_t cells_ = 0;
};

/// The moments of cells [first, last) along x of a block's rows, for callers that go row by row: a row is
/// summed when its first cell is read. `Source` has moments(block, box of cells, MomentArrays&).
template <class Source>
class MomentsByRow {
 public:
  MomentsByRow(const Source& source, int block, int first, int last)
      : source_(source), block_(block), first_(first), last_(last) {}
  Moments operator()(Int3 local_cell) {
    const Int3 begin{first_, local_cell.y, local_cell.z};
    if (begin != begin_) source_.moments(block_, CellBox{begin_ = begin, {last_ - first_, 1, 1}}, row_);
    return row_[local_cell.x - first_];
  }

 private:
  const Source& source_;
  int block_, first_, last_;
  Int3 begin_{-1, -1, -1};  // of the current row
  MomentArrays row_;
};

/// Returns the moments of one cell; calls g with an integral_constant per direction for its population.
template <class Populations>
[[gnu::always_inline]] SILT_DEVICE inline Moments moments_of(Populations&& g) {
  Moments m;
  const auto add = [](double& sum, int factor, double value) {  // factor: -1, 0 or 1, a constant
    if (factor) sum += factor * value;
  };
  for_directions<D3Q19, 0>([&](auto i) __attribute__((always_inline)) {
    const double value = g(i);
    constexpr Int3 v = D3Q19::c[i()];
    m.density_deviation += value;
    add(m.momentum[0], v.x, value);
    add(m.momentum[1], v.y, value);
    add(m.momentum[2], v.z, value);
    add(m.flux[0], v.x * v.x, value);
    add(m.flux[1], v.y * v.y, value);
    add(m.flux[2], v.z * v.z, value);
    add(m.flux[3], v.x * v.y, value);
    add(m.flux[4], v.x * v.z, value);
    add(m.flux[5], v.y * v.z, value);
  });
  return m;
}
/// Returns the moments of cell k, where g[i][k] is the population i that arrives there.
template <class T>
[[gnu::always_inline]] SILT_DEVICE inline Moments moments_of(const T* const (&g)[D3Q19::directions],
                                                             std::ptrdiff_t k) {
  return moments_of([&](auto i) { return g[i()][k]; });
}
/// Returns the moments of cell k after it has given up its excess.
template <class T>
SILT_DEVICE inline Moments moments_of(const T* const (&g)[D3Q19::directions], std::ptrdiff_t k,
                                      ExcessQuanta<T> excess, T stress_share) {
  if (excess == 0) return moments_of(g, k);
  const GivenUp<T> given = given_up<T>(T(excess), stress_share, [&](int i) { return g[i][k]; });
  return moments_of([&](auto i) { return given.left(i(), g[i()][k]); });
}

inline Moments MomentArrays::operator[](std::int64_t cell) const {
  const double* const v = values_.data() + cell;
  Moments m;
  m.density_deviation = v[0];
  for (int d = 0; d < 3; ++d) m.momentum[d] = v[(1 + d) * cells_];
  for (int k = 0; k < 6; ++k) m.flux[k] = v[(4 + k) * cells_];
  return m;
}

}  // namespace silt::lbm
