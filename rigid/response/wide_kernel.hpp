#pragma once
// One number of each of eight pairs, in as many of the machine's vectors as it takes. A vector type of eight
// would do where one register holds it; elsewhere compilers compare and choose such a type number by number.
// Only for *_kernel.cpp: built once an instruction set.
#include <type_traits>

#include "cpu/lanes.hpp"
#include "rigid/response/contact_lanes.hpp"

namespace silt::rigid::SILT_ISA {
namespace {

using PartLanes = silt::Lanes<double>;
using Part = PartLanes::Real;
using PartMask = PartLanes::Mask;
constexpr int part_lanes = PartLanes::count, part_count = lane_count / part_lanes;

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
      : Lanes(each<Lanes, part_count>([&](auto k) { return silt::load<Part>(of.lane + k * part_lanes); })) {}
  /// Part by part: of all at once compilers make a copy in pieces of eight bytes.
  [[gnu::always_inline]] void store(double* lane) const {
    for (int k = 0; k < part_count; ++k) silt::store(lane + k * part_lanes, part[k]);
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
  return each<Lanes, part_count>(
      [&](auto k) { return PartLanes::real(silt::load<PartLanes::Whole>(of + k * part_lanes)); });
}
template <class Of>
[[gnu::always_inline]] inline Mask mask_of(Of of) {
  return each<Mask, part_count>([&](auto k) {
    return each<PartMask, part_lanes>([&](auto l) -> long long { return of(k * part_lanes + l) ? -1 : 0; });
  });
}
[[gnu::always_inline]] inline Lanes square_root(const Lanes& x) {
  return each<Lanes, part_count>([&](auto k) { return PartLanes::root(x.part[k]); });
}
/// Bit l: lane l.
[[gnu::always_inline]] inline unsigned lane_bits(const Mask& m) {
  unsigned bits = 0;
  for (int k = 0; k < part_count; ++k) bits |= silt::lane_bits(m.part[k]) << (k * part_lanes);
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
