#pragma once
// Vectors of the instruction set of a kernel's build: vectors of numbers (VectorOf), operations on them that
// the language lacks (Lanes), and vectors of several registers (Registers). Look-ups, gathers and scatters
// use intrinsics, since compilers split them into scalar instructions. Vectors may have any number of lanes;
// those that fill no register are computed lane by lane. Only for *_kernel.cpp files (SILT_BUILD). Builds for
// a device use plain numbers (scalar.hpp).
#if defined(SILT_SCALAR)
#include "cpu/scalar.hpp"
#else
#include <algorithm>
#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <type_traits>
#include <utility>
#if defined(SILT_HAS_avx512) || defined(SILT_HAS_avx2)
#include <immintrin.h>
#endif

namespace silt::inline SILT_BUILD {

#if defined(SILT_HAS_avx512)
inline constexpr int vector_bytes = 64;
#elif defined(SILT_HAS_avx2)
inline constexpr int vector_bytes = 32;
#else
inline constexpr int vector_bytes = 16;
#endif

/// A vector of n elements, by default as many as a register holds.
template <class E, int n = vector_bytes / int(sizeof(E))>
struct VectorOf {
  typedef E type __attribute__((vector_size(n * sizeof(E))));
};

/// load and store access consecutive numbers in memory, unaligned.
template <class V, class U>
[[gnu::always_inline]] inline V load(const U* from) {
  V v;
  __builtin_memcpy(&v, from, sizeof v);
  return v;
}
template <class V, class U>
[[gnu::always_inline]] inline void store(U* to, const V& v) {
  __builtin_memcpy(to, &v, sizeof v);
}

/// Returns V{make(0), make(1), ...}; the arguments are compile-time constants.
template <class V, int count, class Make>
[[gnu::always_inline]] inline V each(Make make) {
  return [&]<int... k>(std::integer_sequence<int, k...>) __attribute__((always_inline)) {
    return V{make(std::integral_constant<int, k>())...};
  }
  (std::make_integer_sequence<int, count>());
}

/// Returns, as bits, the lanes in which a comparison of 32-bit or 64-bit elements is true.
template <class Mask>
[[gnu::always_inline]] inline unsigned lane_bits(const Mask& mask) {
#if defined(SILT_HAS_avx512)
  if constexpr (sizeof mask == vector_bytes) {
    const auto lanes = std::bit_cast<__m512i>(mask);
    if constexpr (sizeof mask[0] == 8) return _mm512_test_epi64_mask(lanes, lanes);
    return _mm512_test_epi32_mask(lanes, lanes);
  }
#elif defined(SILT_HAS_avx2)
  if constexpr (sizeof mask == vector_bytes) {
    if constexpr (sizeof mask[0] == 8) return unsigned(_mm256_movemask_pd(std::bit_cast<__m256d>(mask)));
    return unsigned(_mm256_movemask_ps(std::bit_cast<__m256>(mask)));
  }
#endif
  unsigned bits = 0;
  for (std::size_t i = 0; i < sizeof mask / sizeof mask[0]; ++i) bits |= unsigned(mask[i] & 1) << i;
  return bits;
}

/// Returns whether the comparison is true in any lane.
template <class Mask>
[[gnu::always_inline]] inline bool any_lane(const Mask& mask) {
#if defined(SILT_HAS_avx512)
  if constexpr (sizeof mask == vector_bytes) {
    const auto lanes = std::bit_cast<__m512i>(mask);
    return _mm512_test_epi32_mask(lanes, lanes) != 0;
  }
#elif defined(SILT_HAS_avx2)
  if constexpr (sizeof mask == vector_bytes) {
    const auto lanes = std::bit_cast<__m256i>(mask);
    return !_mm256_testz_si256(lanes, lanes);
  }
#endif
  auto found = mask[0];
  for (std::size_t i = 1; i < sizeof mask / sizeof found; ++i) found |= mask[i];
  return found != 0;
}

template <class V>
[[gnu::always_inline]] inline auto lane_of(const V& v, int lane) {
  return v[lane];
}
/// Converts the elements of a vector.
template <class To, class From>
[[gnu::always_inline]] inline To converted(const From& from) {
  return __builtin_convertvector(from, To);
}

/// Operations on vectors of n numbers T, and of as many integers.
template <class T, int n = vector_bytes / int(sizeof(T))>
struct Lanes {
  static constexpr int count = n;
  using Real = typename VectorOf<T, count>::type;
  using Whole = typename VectorOf<std::int32_t, count>::type;
  using Quanta = typename VectorOf<std::int64_t, count>::type;
  using Mask = decltype(Real{} < Real{});

  static Real real(const Whole& w) { return __builtin_convertvector(w, Real); }
  static Mask mask(const Whole& w) { return __builtin_convertvector(w, Mask); }
  /// Returns the mask of the first `lanes` lanes.
  static Mask below(int lanes) {
    Whole lane;
    for (int l = 0; l < count; ++l) lane[l] = l;
    return mask(lane < lanes);
  }
  static Real magnitude(const Real& x) {
    return Real(Mask(x) & ~Mask(-Real{}));  // clears the sign bit
  }
  static Real root(const Real& x) {
    Real r;
    for (int l = 0; l < count; ++l) r[l] = std::sqrt(x[l]);
    return r;
  }
  static bool all(const Mask& m) {
#if defined(SILT_HAS_avx512)
    if constexpr (fills_register && sizeof(T) == 4) return _mm512_movepi32_mask(__m512i(m)) == 0xffff;
    if constexpr (fills_register && sizeof(T) == 8) return _mm512_movepi64_mask(__m512i(m)) == 0xff;
#elif defined(SILT_HAS_avx2)
    if constexpr (fills_register) return lane_bits(m) == (1u << count) - 1;
#endif
    bool yes = true;
    for (int l = 0; l < count; ++l) yes &= m[l] != 0;
    return yes;
  }

  // All-true masks are explicit: the plain intrinsics cause false warnings from GCC 12.

  /// The index must be below 24.
  static Whole look_up(const std::int32_t (&table)[32], const Whole& index) {
#if defined(SILT_HAS_avx512)
    if constexpr (fills_register) {
      const __m512i low = _mm512_loadu_si512(table), high = _mm512_loadu_si512(table + 16);
      if constexpr (count == 16) {
        return Whole(_mm512_permutex2var_epi32(low, __m512i(index), high));
      } else {
        using Wide = VectorOf<std::int32_t, 16>::type;
        const Wide wide =
            __builtin_shufflevector(index, index, 0, 1, 2, 3, 4, 5, 6, 7, 0, 1, 2, 3, 4, 5, 6, 7);
        const Wide found = Wide(_mm512_permutex2var_epi32(low, __m512i(wide), high));
        return __builtin_shufflevector(found, found, 0, 1, 2, 3, 4, 5, 6, 7);
      }
    }
#elif defined(SILT_HAS_avx2)
    if constexpr (fills_register) {
      const __m256i at = wide(index);
      const auto eight = [&](int k) {
        const auto from = _mm256_loadu_si256(reinterpret_cast<const __m256i*>(table + 8 * k));
        return _mm256_castsi256_ps(_mm256_permutevar8x32_epi32(from, at));
      };
      const auto bit = [&](int k) { return _mm256_castsi256_ps(_mm256_slli_epi32(at, 31 - k)); };
      const __m256i found = _mm256_castps_si256(
          _mm256_blendv_ps(_mm256_blendv_ps(eight(0), eight(1), bit(3)), eight(2), bit(4)));
      if constexpr (count == 8)
        return Whole(found);
      else
        return Whole(_mm256_castsi256_si128(found));
    }
#endif
    Whole found;
    for (int l = 0; l < count; ++l) found[l] = table[index[l]];
    return found;
  }
  static Real gather(const T* from, const std::int32_t* offset) {
#if defined(SILT_HAS_avx512)
    if constexpr (fills_register) {
      const auto at = load<Whole>(offset);
      if constexpr (count == 16)
        return Real(_mm512_mask_i32gather_ps(__m512{}, __mmask16(-1), __m512i(at), from, 4));
      else
        return Real(_mm512_mask_i32gather_pd(__m512d{}, __mmask8(-1), __m256i(at), from, 8));
    }
#endif
    return each<Real, count>([&](auto l) { return from[offset[l]]; });
  }
  static void scatter(T* to, const std::int32_t* offset, const Real& values) {
#if defined(SILT_HAS_avx512)
    if constexpr (fills_register) {
      const auto at = load<Whole>(offset);
      if constexpr (count == 16)
        return _mm512_i32scatter_ps(to, __m512i(at), __m512(values), 4);
      else
        return _mm512_i32scatter_pd(to, __m256i(at), __m512d(values), 8);
    }
#endif
    for (int l = 0; l < count; ++l) to[offset[l]] = values[l];
  }
  static Real gather(const T* from, const Whole& offset) {
    return gather(from, reinterpret_cast<const std::int32_t*>(&offset));
  }
  static void scatter(T* to, const Whole& offset, const Real& values) {
    scatter(to, reinterpret_cast<const std::int32_t*>(&offset), values);
  }

 private:
  static constexpr bool fills_register = sizeof(Real) == vector_bytes;
#if defined(SILT_HAS_avx2)
  static __m256i wide(const Whole& w) {
    if constexpr (count == 8)
      return __m256i(w);
    else
      return _mm256_castsi128_si256(__m128i(w));
  }
#endif
};

/// n elements in several registers, with the operations of one. Compilers split comparisons and selections of
/// language vectors wider than a register into elements.
template <class E, int n>
struct Registers {
  static constexpr int lanes = std::min(n, vector_bytes / int(sizeof(E))), count = n / lanes;
  using Part = typename VectorOf<E, lanes>::type;
  using Mask = Registers<std::conditional_t<sizeof(E) == 8, std::int64_t, std::int32_t>, n>;
  Part part[count];

  Registers() = default;
  template <class... Parts>
  requires(sizeof...(Parts) == count && (std::is_same_v<Parts, Part> && ...)) Registers(Parts... parts)
      : part{parts...} {}
  Registers(E x) : Registers(each<Registers, count>([&](auto) { return x - Part{}; })) {}
  /// Loads a struct of n elements from memory.
  template <class Stored>
  requires std::is_same_v<decltype(Stored::lane), E[n]> Registers(const Stored& of)
      : Registers(each<Registers, count>([&](auto k) { return load<Part>(of.lane + k * lanes); })) {}
  [[gnu::always_inline]] explicit Registers(const std::int32_t (&whole)[n])
      : Registers(each<Registers, count>([&](auto k) {
          using L = Lanes<E, lanes>;
          return L::real(load<typename L::Whole>(whole + k * lanes));
        })) {}
  /// Returns a vector with of(lane) in each lane.
  template <class Of>
  [[gnu::always_inline]] static Registers gathered(Of of) {
    return each<Registers, count>(
        [&](auto k) { return each<Part, lanes>([&](auto l) { return E(of(k * lanes + l)); }); });
  }
  /// Stores part by part, since compilers would copy the whole in pieces of eight bytes.
  [[gnu::always_inline]] void store(E* to) const {
    for (int k = 0; k < count; ++k) silt::store(to + k * lanes, part[k]);
  }
  E operator[](int l) const { return part[l / lanes][l % lanes]; }

#define SILT_OPERATOR(Result, op)                                                                   \
  [[gnu::always_inline]] friend inline Result operator op(const Registers& a, const Registers& b) { \
    return each<Result, count>([&](auto k) { return a.part[k] op b.part[k]; });                     \
  }
  SILT_OPERATOR(Registers, +)
  SILT_OPERATOR(Registers, -)
  SILT_OPERATOR(Registers, *)
  SILT_OPERATOR(Registers, /)
  SILT_OPERATOR(Registers, &)
  SILT_OPERATOR(Registers, |)
  SILT_OPERATOR(Mask, <)
  SILT_OPERATOR(Mask, >)
  SILT_OPERATOR(Mask, <=)
  SILT_OPERATOR(Mask, >=)
  SILT_OPERATOR(Mask, ==)
  SILT_OPERATOR(Mask, !=)
#undef SILT_OPERATOR
  [[gnu::always_inline]] friend inline Registers operator~(const Registers& a) {
    return each<Registers, count>([&](auto k) { return ~a.part[k]; });
  }
  Registers& operator+=(const Registers& b) {
    return *this = *this + b;
  }
  Registers& operator-=(const Registers& b) {
    return *this = *this - b;
  }
  Registers& operator*=(const Registers& b) {
    return *this = *this * b;
  }

  /// Returns a in the lanes where m is true, else b.
  [[gnu::always_inline]] friend inline Registers choose(const Mask& m, const Registers& a,
                                                        const Registers& b) {
    return each<Registers, count>([&](auto k) -> Part { return m.part[k] ? a.part[k] : b.part[k]; });
  }
  [[gnu::always_inline]] friend inline Registers larger(const Registers& a, const Registers& b) {
    return choose(a > b, a, b);
  }
  [[gnu::always_inline]] friend inline Registers square_root(const Registers& x) {
    return each<Registers, count>([&](auto k) { return Lanes<E, lanes>::root(x.part[k]); });
  }
  /// Returns the largest lane.
  friend inline E largest(const Registers& x) {
    E most = x[0];
    for (int l = 1; l < n; ++l) most = x[l] > most ? x[l] : most;
    return most;
  }
  [[gnu::always_inline]] friend inline unsigned lane_bits(const Registers& mask) {
    unsigned bits = 0;
    for (int k = 0; k < count; ++k) bits |= lane_bits(mask.part[k]) << (k * lanes);
    return bits;
  }
  friend inline bool any_lane(const Registers& mask) {
    return lane_bits(mask) != 0;
  }
};

}  // namespace silt::inline SILT_BUILD

#endif
