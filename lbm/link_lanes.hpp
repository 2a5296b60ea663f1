#pragma once
// What the links' kernels do across lanes, a whole number of link_lanes at a time: look-ups in tables of 32,
// gather and scatter. Compilers take these apart where the hardware has an instruction for them.
#include <bit>
#include <cstdint>

#include "lbm/cut_links.hpp"

#if defined(SILT_ISA_avx512)
#include <immintrin.h>
#endif

namespace silt::lbm {

/// Components of the directions, four bits each, one more than they are.
struct DirectionCodes {
  std::int32_t of[32] = {};
  constexpr DirectionCodes() {
    for (int i = 0; i < directions; ++i) of[i] = (c[i].x + 1) | (c[i].y + 1) << 4 | (c[i].z + 1) << 8;
  }
  static constexpr int x(std::int32_t code) { return (code & 15) - 1; }
  static constexpr int y(std::int32_t code) { return (code >> 4 & 15) - 1; }
  static constexpr int z(std::int32_t code) { return (code >> 8) - 1; }
};

}  // namespace silt::lbm

namespace silt::lbm::SILT_ISA {

#if defined(SILT_ISA_avx512)

inline void look_up(const std::int32_t (&table)[32], const std::int32_t* index, int n, std::int32_t* out) {
  const __m512i low = _mm512_loadu_si512(table), high = _mm512_loadu_si512(table + 16);
  for (int l = 0; l < n; l += 16)
    _mm512_storeu_si512(out + l, _mm512_permutex2var_epi32(low, _mm512_loadu_si512(index + l), high));
}
inline void gather(const float* from, const std::int32_t* at, int n, float* out) {
  for (int l = 0; l < n; l += 16)
    _mm512_storeu_ps(out + l, _mm512_i32gather_ps(_mm512_loadu_si512(at + l), from, 4));
}
inline void gather(const double* from, const std::int32_t* at, int n, double* out) {
  for (int l = 0; l < n; l += 8)
    _mm512_storeu_pd(out + l, _mm512_i32gather_pd(_mm256_loadu_si256((const __m256i*)(at + l)), from, 8));
}
inline void scatter(float* to, const std::int32_t* at, int n, const float* values) {
  for (int l = 0; l < n; l += 16)
    _mm512_i32scatter_ps(to, _mm512_loadu_si512(at + l), _mm512_loadu_ps(values + l), 4);
}
inline void scatter(double* to, const std::int32_t* at, int n, const double* values) {
  for (int l = 0; l < n; l += 8)
    _mm512_i32scatter_pd(to, _mm256_loadu_si256((const __m256i*)(at + l)), _mm512_loadu_pd(values + l), 8);
}

#else

inline void look_up(const std::int32_t (&table)[32], const std::int32_t* index, int n, std::int32_t* out) {
  for (int l = 0; l < n; ++l) out[l] = table[index[l]];
}
template <class T>
void gather(const T* from, const std::int32_t* at, int n, T* out) {
  for (int l = 0; l < n; ++l) out[l] = from[at[l]];
}
template <class T>
void scatter(T* to, const std::int32_t* at, int n, const T* values) {
  for (int l = 0; l < n; ++l) to[at[l]] = values[l];
}

#endif

}  // namespace silt::lbm::SILT_ISA
