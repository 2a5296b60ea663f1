#pragma once
// Sums of vectors of terms in fixed point, so that their order does not matter.
#include <bit>
#include <cstdint>

#include "cpu/lanes.hpp"

namespace silt::lbm::SILT_ISA {

/// Adds terms, each rounded to a whole number of quanta; a term is below 2^50 quanta.
template <class T>
class FixedSum {
 public:
  using Real = typename Lanes<T>::Real;

  /// x is in quanta.
  void add(const Real& x) { sum_ += rounded(x); }
  void subtract(const Real& x) { sum_ -= rounded(x); }
  /// `terms`: how many more vectors were added than subtracted.
  std::int64_t total(std::uint64_t terms) const {
    std::uint64_t all = 0;
    for (int l = 0; l < count; ++l) all += sum_[l];
    return std::int64_t(all - terms * Lanes<T>::count * offset);
  }

 private:
  // as wide as a register: compilers take wider ones apart
  static constexpr int count = vector_bytes / 8;
  using Sum = typename VectorOf<std::uint64_t, count>::type;
#if defined(SILT_ISA_avx512)
  static constexpr std::uint64_t offset = 0;
  static Sum rounded(const Real& x) {
    constexpr __mmask8 all = 0xff;
    if constexpr (sizeof(T) == 8)
      return Sum(_mm512_maskz_cvtpd_epi64(all, __m512d(x)));
    else
      return Sum(_mm512_maskz_cvtps_epi64(all,
                                          __m256(__builtin_shufflevector(x, x, 0, 1, 2, 3, 4, 5, 6, 7)))) +
             Sum(_mm512_maskz_cvtps_epi64(
                 all, __m256(__builtin_shufflevector(x, x, 8, 9, 10, 11, 12, 13, 14, 15))));
  }
#else
  /// x + 3 * 2^51 has the rounded integer in its low mantissa bits; the bits of 3 * 2^51 are taken off the
  /// total.
  static constexpr double magic = 0x1.8p52;
  static constexpr auto offset = std::bit_cast<std::uint64_t>(magic);
  using Wide = typename VectorOf<double, count>::type;
  static Sum rounded(const Wide& x) {
    return std::bit_cast<Sum>(Wide(x + magic));
  }
  static Sum rounded(const Real& x) requires(sizeof(T) == 4) {
#if defined(SILT_ISA_avx2)
    return rounded(Wide(_mm256_cvtps_pd(_mm256_castps256_ps128(__m256(x))))) +
           rounded(Wide(_mm256_cvtps_pd(_mm256_extractf128_ps(__m256(x), 1))));
#else
    return rounded(Wide{x[0], x[1]}) + rounded(Wide{x[2], x[3]});
#endif
  }
#endif
  Sum sum_ = {};
};

}  // namespace silt::lbm::SILT_ISA
