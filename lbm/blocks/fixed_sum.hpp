#pragma once
// Sums of vectors of terms in fixed point, which do not depend on the order of the terms.
#include <bit>
#include <cstdint>

#include "cpu/device_code.hpp"
#include "cpu/lanes.hpp"

namespace silt::lbm::SILT_BUILD {

/// Adds n terms at a time, rounded to whole quanta; the absolute value of a term must be below 2^50 quanta.
template <class T, double quantum = 1.0, int n = Lanes<T>::count>
class FixedSum {
 public:
  using Real = typename VectorOf<T, n>::type;

  [[gnu::always_inline]] SILT_DEVICE void add(const Real& x) { sum_ += rounded(x); }
  /// Returns the sum in quanta; `terms` is the number of terms added less the number of terms subtracted.
  SILT_DEVICE std::int64_t total(std::uint64_t terms) const {
    std::uint64_t all = 0;
#if defined(SILT_SCALAR)
    all = sum_;
#else
    for (int l = 0; l < count; ++l) all += sum_[l];
#endif
    return std::int64_t(all - terms * offset);
  }

 private:
  // as wide as a register, since compilers split wider vectors
#if defined(SILT_SCALAR)
  static constexpr bool fills_register = false;
#else
  static constexpr bool fills_register = n * int(sizeof(T)) == vector_bytes;
#endif
  static constexpr int parts = fills_register ? int(sizeof(double) / sizeof(T)) : 1, count = n / parts;
  using Sum = typename VectorOf<std::uint64_t, count>::type;
  using Wide = typename VectorOf<double, count>::type;
#if defined(SILT_HAS_avx512)
  static constexpr bool converts = fills_register;
#else
  static constexpr bool converts = false;
#endif
  /// The low mantissa bits of x + magic are x in whole quanta; total() subtracts the bits of magic.
  static constexpr double magic = 0x1.8p52 * quantum;
  static constexpr auto offset = converts ? std::uint64_t{0} : std::bit_cast<std::uint64_t>(magic);

  [[gnu::always_inline]] SILT_DEVICE static Sum low_bits(const Wide& x) {
    return std::bit_cast<Sum>(Wide(x + magic));
  }
  [[gnu::always_inline]] SILT_DEVICE static Sum rounded(const Real& x) {
#if defined(SILT_SCALAR)
    return low_bits(double(x));
#else
#if defined(SILT_HAS_avx512)
    if constexpr (converts) {
      constexpr __mmask8 all = 0xff;
      const Real q = x * T(1 / quantum);
      if constexpr (sizeof(T) == 8)
        return Sum(_mm512_maskz_cvtpd_epi64(all, __m512d(q)));
      else
        return Sum(_mm512_maskz_cvtps_epi64(all,
                                            __m256(__builtin_shufflevector(q, q, 0, 1, 2, 3, 4, 5, 6, 7)))) +
               Sum(_mm512_maskz_cvtps_epi64(
                   all, __m256(__builtin_shufflevector(q, q, 8, 9, 10, 11, 12, 13, 14, 15))));
    }
#endif
    if constexpr (parts == 1) return low_bits(__builtin_convertvector(x, Wide));
#if defined(SILT_HAS_avx2)
    else
      return low_bits(Wide(_mm256_cvtps_pd(_mm256_castps256_ps128(__m256(x))))) +
             low_bits(Wide(_mm256_cvtps_pd(_mm256_extractf128_ps(__m256(x), 1))));
#else
    else
      return low_bits(Wide{x[0], x[1]}) + low_bits(Wide{x[2], x[3]});
#endif
#endif
  }

  Sum sum_ = {};
};

}  // namespace silt::lbm::SILT_BUILD
