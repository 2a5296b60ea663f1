#pragma once
// The vectors of the instruction set a kernel is being built for. Only for *_kernel.cpp files, which are
// built once each (SILT_ISA).

#include <bit>
#include <cstddef>
#if defined(SILT_ISA_avx512) || defined(SILT_ISA_avx2)
#include <immintrin.h>
#endif

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

/// The lanes in which a comparison of two vectors of 32-bit or 64-bit elements held, as bits.
template <class Mask>
[[gnu::always_inline]] inline unsigned lane_bits(const Mask& mask) {
  [[maybe_unused]] constexpr bool wide = sizeof mask[0] == 8;
#if defined(SILT_ISA_avx512)
  const auto lanes = std::bit_cast<__m512i>(mask);
  if constexpr (wide) return _mm512_test_epi64_mask(lanes, lanes);
  return _mm512_test_epi32_mask(lanes, lanes);
#elif defined(SILT_ISA_avx2)
  if constexpr (wide) return unsigned(_mm256_movemask_pd(std::bit_cast<__m256d>(mask)));
  return unsigned(_mm256_movemask_ps(std::bit_cast<__m256>(mask)));
#else
  unsigned bits = 0;
  for (std::size_t i = 0; i < sizeof mask / sizeof mask[0]; ++i) bits |= unsigned(mask[i] & 1) << i;
  return bits;
#endif
}

}  // namespace silt::lbm::SILT_ISA
