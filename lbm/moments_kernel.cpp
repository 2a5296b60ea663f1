// Built once an instruction set: the moments of a row of cells, and their totals.
#include <bit>
#include <limits>

#include "cpu/prefetch.hpp"
#include "lbm/fixed_sum.hpp"
#include "lbm/moments.hpp"

namespace silt::lbm::SILT_ISA {
namespace {

constexpr int prefetch_bytes = 256;

template <class T>
void sum_moments(const T* const (&g)[directions], std::ptrdiff_t cells, std::ptrdiff_t stride,
                 double* moments) {
#pragma GCC ivdep
  for (std::ptrdiff_t k = 0; k < cells; ++k) {
    const Moments m = moments_of(g, k);
    moments[k] = m.density_deviation;
    for (int d = 0; d < 3; ++d) moments[k + (1 + d) * stride] = m.momentum[d];
    for (int j = 0; j < 6; ++j) moments[k + (4 + j) * stride] = m.flux[j];
  }
}

/// Totals of which each of n lanes has its own: a cell's in its own precision, their sums in quanta.
template <class T, int n>
class LaneTotals {
 public:
  /// Adds the cells from k on; the first `seen` of them have been added before, and add nothing.
  template <bool some_seen>
  [[gnu::always_inline]] void add(const T* const (&g)[directions], std::ptrdiff_t k,
                                  const std::array<T, 3>& half_force, int seen = 0) {
    V deviation = load<V>(g[0] + k), momentum[3]{};
#pragma GCC unroll 19
    for (int i = 0; i < directions; ++i) prefetch_to_read(g[i] + k + prefetch_bytes / sizeof(T));
#pragma GCC unroll 9
    for (int i = 1; i < directions; i += 2) {  // opposite ones follow each other
      const V along = load<V>(g[i] + k), against = load<V>(g[i + 1] + k), difference = along - against;
      deviation += along + against;
#pragma GCC unroll 3
      for (int d = 0; d < 3; ++d)
        if (c[i][d]) momentum[d] = c[i][d] > 0 ? momentum[d] + difference : momentum[d] - difference;
    }
    V square{};
    for (int d = 0; d < 3; ++d) square += (momentum[d] + half_force[d]) * (momentum[d] + half_force[d]);
    numbers_ += square + deviation;
    square_ = square > square_ ? square : square_;
    most_ = deviation > most_ ? deviation : most_;
    least_ = deviation < least_ ? deviation : least_;
    if constexpr (some_seen) {
      V share;
      for (int lane = 0; lane < n; ++lane) share[lane] = lane >= seen;
      deviation *= share, square *= share;
      for (int d = 0; d < 3; ++d) momentum[d] *= share;
    }
    mass_.add(deviation);
    for (int d = 0; d < 3; ++d) momentum_[d].add(momentum[d]);
#pragma GCC unroll 2
    for (int part = 0; part < parts; ++part) {
      constexpr double large = 0x1.8p52 * CellTotals::energy_quantum;  // a sum with it is in whole quanta
      const W energy = 0.5 * wide(square, part);
      energy_.add(energy);
      energy_rest_.add(energy - ((energy + large) - large));
    }
  }

  /// Adds the totals to t; `cells` counts those that were seen before, too.
  void give(std::ptrdiff_t cells, CellTotals& t) const {
    const std::uint64_t terms = std::uint64_t(cells);
    t.mass += mass_.total(terms);
    for (int d = 0; d < 3; ++d) t.momentum[d] += momentum_[d].total(terms);
    t.energy += energy_.total(terms);
    t.energy_rest += energy_rest_.total(terms);
    double numbers = 0;
    for (int lane = 0; lane < n; ++lane) {
      numbers += numbers_[lane];
      t.speed_squared = square_[lane] > t.speed_squared ? square_[lane] : t.speed_squared;
      t.most_deviation = most_[lane] > t.most_deviation ? most_[lane] : t.most_deviation;
      t.least_deviation = least_[lane] < t.least_deviation ? least_[lane] : t.least_deviation;
    }
    constexpr double fast = CellTotals::no_flow_is_so_fast, dense = CellTotals::no_fluid_is_so_dense;
    t.sound &= numbers - numbers == 0 && t.speed_squared < fast * fast && t.most_deviation < dense &&
               t.least_deviation > -dense;
  }

 private:
  static constexpr int parts = n > 1 ? int(sizeof(double) / sizeof(T)) : 1;  // that fill a vector of doubles
  using V = typename VectorOf<T, n>::type;
  using W = typename VectorOf<double, n / parts>::type;

  [[gnu::always_inline]] static W wide(const V& v, int part) {
#if defined(SILT_ISA_avx512)  // the compiler converts halves of a vector and joins them
    if constexpr (parts == 2) {
      struct Halves {
        __m256 half[2];
      };
      return std::bit_cast<W>(_mm512_cvtps_pd(std::bit_cast<Halves>(v).half[part]));
    }
#endif
    struct Parts {
      typename VectorOf<T, n / parts>::type part[parts];
    };
    return __builtin_convertvector(std::bit_cast<Parts>(v).part[part], W);
  }

  FixedSum<T, mass_quantum, n> mass_;
  FixedSum<T, CellTotals::momentum_quantum, n> momentum_[3];
  FixedSum<double, CellTotals::energy_quantum, n / parts> energy_;
  FixedSum<double, CellTotals::energy_rest_quantum, n / parts> energy_rest_;
  V numbers_{};  // numbers if all are
  V square_ = V{} - 1, most_ = V{} + std::numeric_limits<T>::lowest(),
    least_ = V{} + std::numeric_limits<T>::max();
};

template <class T>
CellTotals total(const T* const (&g)[directions], const CellRows& rows, const std::array<double, 3>& force) {
  constexpr int lanes = vector_bytes / int(sizeof(T));
  const std::array<T, 3> half_force = {T(0.5 * force[0]), T(0.5 * force[1]), T(0.5 * force[2])};
  CellTotals all;
  if (rows.cells < lanes) {
    LaneTotals<T, 1> single;
    for (std::ptrdiff_t row = 0; row < rows.rows; ++row)
      for (int k = 0; k < rows.cells; ++k) single.template add<false>(g, row * rows.stride + k, half_force);
    single.give(std::int64_t(rows.cells) * rows.rows, all);
    return all;
  }
  LaneTotals<T, lanes> many;
  const int rest = rows.cells % lanes, most = rows.cells - rest;
  for (std::ptrdiff_t row = 0; row < rows.rows; ++row) {
    const std::ptrdiff_t begin = row * rows.stride;
    for (int k = 0; k < most; k += lanes) many.template add<false>(g, begin + k, half_force);
    if (rest > 0) many.template add<true>(g, begin + rows.cells - lanes, half_force, lanes - rest);
  }
  many.give(std::int64_t(most + (rest > 0 ? lanes : 0)) * rows.rows, all);
  return all;
}

}  // namespace

template <class T>
MomentsKernels<T> moments_kernels() {
  return {sum_moments<T>, total<T>};
}
template MomentsKernels<float> moments_kernels<float>();
template MomentsKernels<double> moments_kernels<double>();

}  // namespace silt::lbm::SILT_ISA
