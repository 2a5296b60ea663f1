#pragma once
// The totals of cells (CellTotals) in vectors of cells, or in single numbers in builds for a device.
#include <bit>
#include <limits>

#if !defined(SILT_SCALAR)
#include "cpu/prefetch.hpp"
#endif
#include "lbm/blocks/fixed_sum.hpp"
#include "lbm/blocks/moments.hpp"

namespace silt::lbm::SILT_BUILD {

/// The least and the largest temperature of cells of a block; nothing where the fluid carries none.
template <class T>
class TemperatureRange {
 public:
  TemperatureRange(const Block<T>& block, Parity parity) {
    if (const Block<T, D3Q7>* const of = block.temperature())
      for (int i = 0; i < D3Q7::directions; ++i) g_[i] = of->data() + of->arriving(i, parity);
  }
  SILT_DEVICE void add(std::ptrdiff_t cell) {
    if (!g_[0]) return;
    T t = g_[0][cell];
    for (int i = 1; i < D3Q7::directions; ++i) t += g_[i][cell];
    numbers_ += t;
    least_ = t < least_ ? t : least_;
    most_ = t > most_ ? t : most_;
  }
  SILT_DEVICE void give(CellTotals& t) const {
    if (!g_[0]) return;
    t.least_temperature = double(least_);
    t.most_temperature = numbers_ - numbers_ == 0 ? double(most_) : std::numeric_limits<double>::infinity();
  }

 private:
  const T* g_[D3Q7::directions]{};  // populations that arrive at cell 0 of the block
  T numbers_ = 0, least_ = std::numeric_limits<T>::max(), most_ = -least_;
};

/// Totals of n lanes. Values of a cell are in the precision of its populations, sums in quanta.
template <class T, int n>
class LaneTotals {
 public:
  /// Adds n cells from k on. The first `seen` of them were added before and add nothing to the sums.
  template <bool some_seen>
  [[gnu::always_inline]] SILT_DEVICE void add(const T* const (&g)[D3Q19::directions], std::ptrdiff_t k,
                                              const T (&half_force)[3], int seen = 0) {
    V deviation = load<V>(g[0] + k), momentum[3]{};
#if !defined(SILT_SCALAR)
    constexpr int prefetch_bytes = 256;
#pragma GCC unroll 19
    for (int i = 0; i < D3Q19::directions; ++i) prefetch_to_read(g[i] + k + prefetch_bytes / sizeof(T));
#endif
    for_directions<D3Q19, 1>([&](auto i) __attribute__((always_inline)) {
      if constexpr (i() % 2 == 1) {  // opposites are neighbours
        const V along = load<V>(g[i()] + k), against = load<V>(g[i() + 1] + k), difference = along - against;
        deviation += along + against;
        constexpr Int3 v = D3Q19::c[i()];
        const auto push = [&](V & sum, int towards) __attribute__((always_inline)) {
          if (towards) sum = towards > 0 ? sum + difference : sum - difference;
        };
        push(momentum[0], v.x), push(momentum[1], v.y), push(momentum[2], v.z);
      }
    });
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
    mass_.add(deviation), mass_square_.add(deviation * deviation);
    for (int d = 0; d < 3; ++d) momentum_[d].add(momentum[d]);
#pragma GCC unroll 2
    for (int part = 0; part < parts; ++part) {
      constexpr double large = 0x1.8p52 * CellTotals::energy_quantum;  // adding it rounds to whole quanta
      const W energy = 0.5 * wide(square, part);
      energy_.add(energy);
      energy_rest_.add(energy - ((energy + large) - large));
    }
  }

  /// Adds the totals to t; `cells` counts all cells added, including those that were seen before.
  SILT_DEVICE void give(std::ptrdiff_t cells, CellTotals& t) const {
    const std::uint64_t terms = std::uint64_t(cells);
    t.mass += mass_.total(terms), t.mass_square += mass_square_.total(terms);
    for (int d = 0; d < 3; ++d) t.momentum[d] += momentum_[d].total(terms);
    t.energy += energy_.total(terms);
    t.energy_rest += energy_rest_.total(terms);
    double numbers = 0;
    for (int lane = 0; lane < n; ++lane) {
      const double square = lane_of(square_, lane), most = lane_of(most_, lane),
                   least = lane_of(least_, lane);
      numbers += lane_of(numbers_, lane);
      t.speed_squared = square > t.speed_squared ? square : t.speed_squared;
      t.most_deviation = most > t.most_deviation ? most : t.most_deviation;
      t.least_deviation = least < t.least_deviation ? least : t.least_deviation;
    }
    constexpr double fast = CellTotals::no_flow_is_so_fast, dense = CellTotals::no_fluid_is_so_dense;
    t.sound &= numbers - numbers == 0 && t.speed_squared < fast * fast && t.most_deviation < dense &&
               t.least_deviation > -dense;
  }

 private:
  static constexpr int parts = n > 1 ? int(sizeof(double) / sizeof(T)) : 1;  // of V, each a vector of doubles
  using V = typename VectorOf<T, n>::type;
  using W = typename VectorOf<double, n / parts>::type;

  [[gnu::always_inline]] SILT_DEVICE static W wide(const V& v, [[maybe_unused]] int part) {
#if defined(SILT_SCALAR)
    return v;
#else
#if defined(SILT_HAS_avx512)  // the compiler would convert halves of a vector and join them
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
#endif
  }

  FixedSum<T, mass_quantum, n> mass_;
  FixedSum<T, CellTotals::square_quantum, n> mass_square_;
  FixedSum<T, CellTotals::momentum_quantum, n> momentum_[3];
  FixedSum<double, CellTotals::energy_quantum, n / parts> energy_;
  FixedSum<double, CellTotals::energy_rest_quantum, n / parts> energy_rest_;
  V numbers_{};  // finite if all values are
  V square_ = V{} - 1, most_ = V{} + std::numeric_limits<T>::lowest(),
    least_ = V{} + std::numeric_limits<T>::max();
};

}  // namespace silt::lbm::SILT_BUILD
