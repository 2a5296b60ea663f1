#pragma once
// One number of each of eight pairs, in as many of the machine's vectors as it takes. A vector type of eight
// would do where one register holds it; elsewhere compilers compare and choose such a type number by number.
// Only for *_kernel.cpp: built once an instruction set.
#include <cmath>
#include <cstring>
#include <type_traits>
#include <utility>

#if defined SILT_ISA_avx512 || defined SILT_ISA_avx2
#include <immintrin.h>
#endif

#include "rigid/response/contact_lanes.hpp"

namespace silt::rigid::SILT_ISA {
namespace {

#if defined SILT_ISA_avx512
constexpr int part_lanes = 8;
#elif defined SILT_ISA_avx2
constexpr int part_lanes = 4;
#else
constexpr int part_lanes = 2;
#endif
constexpr int part_count = lane_count / part_lanes;

using Part = double __attribute__((vector_size(part_lanes * sizeof(double))));
using PartMask = decltype(Part{} < Part{});

/// Calls use(0), use(1), ... with constants, and makes a Result of what they return.
template <class Result, int count, class Use>
[[gnu::always_inline]] inline Result each(Use use) {
  return [&]<int... k>(std::integer_sequence<int, k...>) __attribute__((always_inline)) {
    return Result{use(std::integral_constant<int, k>())...};
  }
  (std::make_integer_sequence<int, count>());
}

/// All bits of a lane set: true.
struct Mask {
  PartMask part[part_count];

  bool operator[](int l) const { return part[l / part_lanes][l % part_lanes] != 0; }
};

struct Lanes {
  Part part[part_count];

  Lanes() = default;
  template <class... Parts>
  requires(sizeof...(Parts) == part_count && (std::is_same_v<Parts, Part> && ...)) Lanes(Parts... parts)
      : part{parts...} {}
  Lanes(double x) : Lanes(each<Lanes, part_count>([&](auto) { return x - Part{}; })) {}
  Lanes(const Real8& of)
      : Lanes(each<Lanes, part_count>([&](auto k) {
          Part p;
          std::memcpy(&p, of.lane + k * part_lanes, sizeof p);
          return p;
        })) {}
  /// Part by part: of all at once compilers make a copy in pieces of eight bytes.
  [[gnu::always_inline]] void store(double* lane) const {
    for (int k = 0; k < part_count; ++k) std::memcpy(lane + k * part_lanes, &part[k], sizeof part[k]);
  }
  double operator[](int l) const { return part[l / part_lanes][l % part_lanes]; }
};

#define SILT_LANES_OPERATOR(Result, op)                                              \
  [[gnu::always_inline]] inline Result operator op(const Lanes& a, const Lanes& b) { \
    return each<Result, part_count>([&](auto k) { return a.part[k] op b.part[k]; }); \
  }
SILT_LANES_OPERATOR(Lanes, +)
SILT_LANES_OPERATOR(Lanes, -)
SILT_LANES_OPERATOR(Lanes, *)
SILT_LANES_OPERATOR(Lanes, /)
SILT_LANES_OPERATOR(Mask, <)
SILT_LANES_OPERATOR(Mask, >)
SILT_LANES_OPERATOR(Mask, <=)
SILT_LANES_OPERATOR(Mask, >=)
SILT_LANES_OPERATOR(Mask, ==)
SILT_LANES_OPERATOR(Mask, !=)
#undef SILT_LANES_OPERATOR
inline Lanes& operator+=(Lanes& a, const Lanes& b) {
  return a = a + b;
}
inline Lanes& operator-=(Lanes& a, const Lanes& b) {
  return a = a - b;
}
inline Lanes& operator*=(Lanes& a, const Lanes& b) {
  return a = a * b;
}

[[gnu::always_inline]] inline Mask operator&(const Mask& a, const Mask& b) {
  return each<Mask, part_count>([&](auto k) { return a.part[k] & b.part[k]; });
}
[[gnu::always_inline]] inline Mask operator|(const Mask& a, const Mask& b) {
  return each<Mask, part_count>([&](auto k) { return a.part[k] | b.part[k]; });
}
[[gnu::always_inline]] inline Mask operator~(const Mask& a) {
  return each<Mask, part_count>([&](auto k) { return ~a.part[k]; });
}

/// Lane by lane, a where m is set, else b.
[[gnu::always_inline]] inline Lanes choose(const Mask& m, const Lanes& a, const Lanes& b) {
  return each<Lanes, part_count>([&](auto k) -> Part { return m.part[k] ? a.part[k] : b.part[k]; });
}
[[gnu::always_inline]] inline Mask choose(const Mask& m, const Mask& a, const Mask& b) {
  return (m & a) | (~m & b);
}
[[gnu::always_inline]] inline Lanes larger(const Lanes& a, const Lanes& b) {
  return choose(a > b, a, b);
}
/// What of(lane) returns, in each lane.
template <class Of>
[[gnu::always_inline]] inline Lanes gathered(Of of) {
  return each<Lanes, part_count>(
      [&](auto k) { return each<Part, part_lanes>([&](auto l) { return double(of(k * part_lanes + l)); }); });
}
[[gnu::always_inline]] inline Lanes whole_numbers(const std::int32_t (&of)[lane_count]) {
  return each<Lanes, part_count>([&](auto k) {
    std::int32_t __attribute__((vector_size(part_lanes * sizeof(std::int32_t)))) part;
    std::memcpy(&part, of + k * part_lanes, sizeof part);
    return __builtin_convertvector(part, Part);
  });
}
template <class Of>
[[gnu::always_inline]] inline Mask mask_of(Of of) {
  return each<Mask, part_count>([&](auto k) {
    return each<PartMask, part_lanes>([&](auto l) -> long long { return of(k * part_lanes + l) ? -1 : 0; });
  });
}
[[gnu::always_inline]] inline Lanes square_root(const Lanes& x) {
  return each<Lanes, part_count>([&](auto k) {
    Part root;
    for (int l = 0; l < part_lanes; ++l) root[l] = std::sqrt(x.part[k][l]);
    return root;
  });
}
/// Bit l: lane l.
[[gnu::always_inline]] inline unsigned lane_bits(const Mask& m) {
  unsigned bits = 0;
  for (int k = 0; k < part_count; ++k) {
#if defined SILT_ISA_avx512
    bits |= unsigned(_mm512_movepi64_mask(__m512i(m.part[k]))) << (k * part_lanes);
#elif defined SILT_ISA_avx2
    bits |= unsigned(_mm256_movemask_pd(__m256d(m.part[k]))) << (k * part_lanes);
#else
    for (int l = 0; l < part_lanes; ++l) bits |= unsigned(m.part[k][l] & 1) << (k * part_lanes + l);
#endif
  }
  return bits;
}
inline bool any(const Mask& m) {
  return lane_bits(m) != 0;
}
/// The largest of the lanes.
inline double largest(const Lanes& x) {
  double most = x[0];
  for (int l = 1; l < lane_count; ++l) most = x[l] > most ? x[l] : most;
  return most;
}

}  // namespace
}  // namespace silt::rigid::SILT_ISA
