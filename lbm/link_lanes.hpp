#pragma once
// Vectors of links, one lane a link: look-ups in tables of 32, gather, scatter, and sums of rounded terms.
// Compilers take these apart where the hardware has an instruction for them. (Masks that are all ones: the
// plain forms of the intrinsics draw false warnings from GCC 12.)
#include <bit>
#include <cmath>
#include <cstdint>

#include "lbm/cut_links.hpp"
#include "lbm/isa_vector.hpp"

#if defined(SILT_ISA_avx512) || defined(SILT_ISA_avx2)
#include <immintrin.h>
#endif

namespace silt::lbm::SILT_ISA {

template <class T>
struct Lanes {
  static constexpr int count = vector_bytes / int(sizeof(T));
  static_assert(link_lanes % count == 0 && count % 2 == 0);  // two: both ends of a crossing link
  using Real = typename VectorOf<T, count>::type;
  using Whole = typename VectorOf<std::int32_t, count>::type;
  using Quanta = typename VectorOf<std::int64_t, count>::type;
  using Mask = decltype(Real{} < Real{});

  template <class V, class U>
  static V load(const U* from) {
    V v;
    __builtin_memcpy(&v, from, sizeof v);
    return v;
  }
  static Real real(const Whole& w) { return __builtin_convertvector(w, Real); }
  static Mask mask(const Whole& w) { return __builtin_convertvector(w, Mask); }
  /// Lanes below n.
  static Mask below(int n) {
    Whole lane;
    for (int l = 0; l < count; ++l) lane[l] = l;
    return mask(lane < n);
  }
  static Real magnitude(const Real& x) {
    return Real(Mask(x) & ~Mask(-Real{}));  // all but the sign
  }
  static Real root(const Real& x) {
    Real r;
    for (int l = 0; l < count; ++l) r[l] = std::sqrt(x[l]);
    return r;
  }
  static bool all(const Mask& m) {
#if defined(SILT_ISA_avx512)
    if constexpr (sizeof(T) == 4)
      return _mm512_movepi32_mask(__m512i(m)) == 0xffff;
    else
      return _mm512_movepi64_mask(__m512i(m)) == 0xff;
#elif defined(SILT_ISA_avx2)
    return lane_bits(m) == (1u << count) - 1;
#else
    bool yes = true;
    for (int l = 0; l < count; ++l) yes &= m[l] != 0;
    return yes;
#endif
  }

#if defined(SILT_ISA_avx512)
  static Whole look_up(const std::int32_t (&table)[32], const Whole& index) {
    const __m512i low = _mm512_loadu_si512(table), high = _mm512_loadu_si512(table + 16);
    if constexpr (count == 16) {
      return Whole(_mm512_permutex2var_epi32(low, __m512i(index), high));
    } else {
      using Wide = VectorOf<std::int32_t, 16>::type;
      const Wide wide = __builtin_shufflevector(index, index, 0, 1, 2, 3, 4, 5, 6, 7, 0, 1, 2, 3, 4, 5, 6, 7);
      const Wide found = Wide(_mm512_permutex2var_epi32(low, __m512i(wide), high));
      return __builtin_shufflevector(found, found, 0, 1, 2, 3, 4, 5, 6, 7);
    }
  }
  static Real gather(const T* from, const std::int32_t* offsets) {
    const auto at = load<Whole>(offsets);
    if constexpr (count == 16)
      return Real(_mm512_mask_i32gather_ps(__m512{}, __mmask16(-1), __m512i(at), from, 4));
    else
      return Real(_mm512_mask_i32gather_pd(__m512d{}, __mmask8(-1), __m256i(at), from, 8));
  }
  static void scatter(T* to, const std::int32_t* offsets, const Real& values) {
    const auto at = load<Whole>(offsets);
    if constexpr (count == 16)
      _mm512_i32scatter_ps(to, __m512i(at), __m512(values), 4);
    else
      _mm512_i32scatter_pd(to, __m256i(at), __m512d(values), 8);
  }
#elif defined(SILT_ISA_avx2)
  /// index: below 24.
  static Whole look_up(const std::int32_t (&table)[32], const Whole& index) {
    const __m256i at = wide(index);
    const auto eight = [&](int k) {
      const auto from = _mm256_loadu_si256(reinterpret_cast<const __m256i*>(table + 8 * k));
      return _mm256_castsi256_ps(_mm256_permutevar8x32_epi32(from, at));
    };
    const auto bit = [&](int n) { return _mm256_castsi256_ps(_mm256_slli_epi32(at, 31 - n)); };
    const __m256i found =
        _mm256_castps_si256(_mm256_blendv_ps(_mm256_blendv_ps(eight(0), eight(1), bit(3)), eight(2), bit(4)));
    if constexpr (count == 8)
      return Whole(found);
    else
      return Whole(_mm256_castsi256_si128(found));
  }
  static Real gather(const T* from, const std::int32_t* offset) {
    if constexpr (count == 8)
      return Real{from[offset[0]], from[offset[1]], from[offset[2]], from[offset[3]],
                  from[offset[4]], from[offset[5]], from[offset[6]], from[offset[7]]};
    else
      return Real{from[offset[0]], from[offset[1]], from[offset[2]], from[offset[3]]};
  }
  static void scatter(T* to, const std::int32_t* offset, const Real& values) {
    for (int l = 0; l < count; ++l) to[offset[l]] = values[l];
  }
#else
  static Whole look_up(const std::int32_t (&table)[32], const Whole& index) {
    Whole found;
    for (int l = 0; l < count; ++l) found[l] = table[index[l]];
    return found;
  }
  static Real gather(const T* from, const std::int32_t* offset) {
    Real values;
    for (int l = 0; l < count; ++l) values[l] = from[offset[l]];
    return values;
  }
  static void scatter(T* to, const std::int32_t* offset, const Real& values) {
    for (int l = 0; l < count; ++l) to[offset[l]] = values[l];
  }
#endif

#if defined(SILT_ISA_avx2)

 private:
  static __m256i wide(const Whole& w) {
    if constexpr (count == 8)
      return __m256i(w);
    else
      return _mm256_castsi128_si256(__m128i(w));
  }
#endif
};

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
