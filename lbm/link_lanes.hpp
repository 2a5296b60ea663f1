#pragma once
// Vectors of links, one lane a link: look-ups in tables of 32, gather, scatter, and sums of rounded terms.
// Compilers take these apart where the hardware has an instruction for them. (Masks that are all ones: the
// plain forms of the intrinsics draw false warnings from GCC 12.)
#include <bit>
#include <cmath>
#include <cstdint>

#include "lbm/cut_links.hpp"
#include "lbm/isa_vector.hpp"

#if defined(SILT_ISA_avx512)
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
  static Real magnitude(const Real& x) { return x < T(0) ? -x : x; }
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
  static Real gather(const T* from, const Whole& at) {
    if constexpr (count == 16)
      return Real(_mm512_mask_i32gather_ps(__m512{}, __mmask16(-1), __m512i(at), from, 4));
    else
      return Real(_mm512_mask_i32gather_pd(__m512d{}, __mmask8(-1), __m256i(at), from, 8));
  }
  static void scatter(T* to, const Whole& at, const Real& values) {
    if constexpr (count == 16)
      _mm512_i32scatter_ps(to, __m512i(at), __m512(values), 4);
    else
      _mm512_i32scatter_pd(to, __m256i(at), __m512d(values), 8);
  }
#else
  static Whole look_up(const std::int32_t (&table)[32], const Whole& index) {
    Whole found;
    for (int l = 0; l < count; ++l) found[l] = table[index[l]];
    return found;
  }
  static Real gather(const T* from, const Whole& at) {
    Real values;
    for (int l = 0; l < count; ++l) values[l] = from[at[l]];
    return values;
  }
  static void scatter(T* to, const Whole& at, const Real& values) {
    for (int l = 0; l < count; ++l) to[at[l]] = values[l];
  }
#endif
};

/// Adds terms, each rounded to a whole number of quanta; a term is below 2^50 quanta.
template <class T>
class FixedSum {
 public:
  using Real = typename Lanes<T>::Real;

#if defined(SILT_ISA_avx512)
  /// x is in quanta.
  void add(const Real& x) {
    sum_ += rounded(x);
  }
  void subtract(const Real& x) {
    sum_ -= rounded(x);
  }
  std::int64_t total() const {
    const auto four =
        __builtin_shufflevector(sum_, sum_, 0, 1, 2, 3) + __builtin_shufflevector(sum_, sum_, 4, 5, 6, 7);
    const auto two = __builtin_shufflevector(four, four, 0, 1) + __builtin_shufflevector(four, four, 2, 3);
    return two[0] + two[1];
  }

 private:
  using Sum = VectorOf<std::int64_t, 8>::type;
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
  Sum sum_ = {};
#else
  void add(const Real& x) {
    sum_ += rounded(x);
  }
  void subtract(const Real& x) {
    sum_ -= rounded(x);
  }
  std::int64_t total() const {
    std::int64_t all = 0;
    for (int l = 0; l < Lanes<T>::count; ++l) all += sum_[l];
    return all;
  }

 private:
  using Quanta = typename Lanes<T>::Quanta;
  using Wide = typename VectorOf<double, Lanes<T>::count>::type;
  /// x + 3 * 2^51 has the rounded integer in its low mantissa bits.
  static Quanta rounded(const Real& x) {
    constexpr double magic = 0x1.8p52;
    const Wide shifted = __builtin_convertvector(x, Wide) + magic;
    return std::bit_cast<Quanta>(shifted) - std::bit_cast<std::int64_t>(magic);
  }
  Quanta sum_ = {};
#endif
};

}  // namespace silt::lbm::SILT_ISA
