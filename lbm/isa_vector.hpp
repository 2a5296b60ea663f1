#pragma once
// The vectors of the instruction set a kernel is being built for. Only for *_kernel.cpp files, which are
// built once each (SILT_ISA).

#include <immintrin.h>
#include <bit>
#include <cstddef>

namespace silt::lbm::SILT_ISA {

#if defined(SILT_ISA_avx512)
inline constexpr int vector_bytes = 64;
#elif defined(SILT_ISA_avx2)
inline constexpr int vector_bytes = 32;
#else
inline constexpr int vector_bytes = 16;
#endif

/// n elements; without n as many as a register has.
template <class E, int n = vector_bytes / int(sizeof(E))>
struct VectorOf {
  typedef E type __attribute__((vector_size(n * sizeof(E))));
};

/// Returns the larger one in each lane, in one instruction; `kept` where `found` is not a number.
template <class V>
[[gnu::always_inline]] inline V larger(const V& found, const V& kept) {
  constexpr bool single = sizeof(V{}[0]) == 4;
#if defined(SILT_ISA_avx512)
  if constexpr (single)
    return std::bit_cast<V>(_mm512_max_ps(std::bit_cast<__m512>(found), std::bit_cast<__m512>(kept)));
  else
    return std::bit_cast<V>(_mm512_max_pd(std::bit_cast<__m512d>(found), std::bit_cast<__m512d>(kept)));
#elif defined(SILT_ISA_avx2)
  if constexpr (single)
    return std::bit_cast<V>(_mm256_max_ps(std::bit_cast<__m256>(found), std::bit_cast<__m256>(kept)));
  else
    return std::bit_cast<V>(_mm256_max_pd(std::bit_cast<__m256d>(found), std::bit_cast<__m256d>(kept)));
#else
  if constexpr (single)
    return std::bit_cast<V>(_mm_max_ps(std::bit_cast<__m128>(found), std::bit_cast<__m128>(kept)));
  else
    return std::bit_cast<V>(_mm_max_pd(std::bit_cast<__m128d>(found), std::bit_cast<__m128d>(kept)));
#endif
}

/// Whether a comparison of two vectors held in any lane.
template <class Mask>
[[gnu::always_inline]] inline bool any_lane(const Mask& mask) {
#if defined(SILT_ISA_avx512)
  const auto lanes = std::bit_cast<__m512i>(mask);
  return _mm512_test_epi32_mask(lanes, lanes) != 0;
#elif defined(SILT_ISA_avx2)
  const auto lanes = std::bit_cast<__m256i>(mask);
  return !_mm256_testz_si256(lanes, lanes);
#else
  auto found = mask[0];
  for (std::size_t i = 1; i < sizeof mask / sizeof found; ++i) found |= mask[i];
  return found != 0;
#endif
}

}  // namespace silt::lbm::SILT_ISA
