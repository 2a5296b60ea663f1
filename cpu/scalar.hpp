#pragma once
// Vectors of one lane, that is plain numbers, for kernels built for a device (SILT_SCALAR).
#include <cmath>
#include <cstdint>

#include "cpu/device_code.hpp"

namespace silt::inline SILT_BUILD {

template <class E, int n = 1>
struct VectorOf {
  static_assert(n == 1);
  using type = E;
};

template <class V, class U>
SILT_DEVICE inline V load(const U* from) {
  return V(*from);
}
template <class V>
SILT_DEVICE inline void store(V* to, const V& v) {
  *to = v;
}
SILT_DEVICE inline bool any_lane(bool lane) {
  return lane;
}
template <class V>
SILT_DEVICE inline const V& lane_of(const V& v, int) {
  return v;
}
template <class To, class From>
SILT_DEVICE inline To converted(const From& from) {
  return To(from);
}

template <class T>
struct Lanes {
  static constexpr int count = 1;
  using Real = T;
  using Whole = std::int32_t;
  using Quanta = std::int64_t;
  using Mask = bool;

  SILT_DEVICE static Real real(Whole w) { return T(w); }
  SILT_DEVICE static Mask mask(bool lane) { return lane; }
  SILT_DEVICE static Mask below(int lanes) { return lanes > 0; }
  SILT_DEVICE static Real magnitude(Real x) { return std::fabs(x); }
  SILT_DEVICE static Real root(Real x) { return std::sqrt(x); }
  SILT_DEVICE static bool all(Mask m) { return m; }
  SILT_DEVICE static Whole look_up(const std::int32_t (&table)[32], Whole index) { return table[index]; }
  SILT_DEVICE static Real gather(const T* from, const Whole& offset) { return from[offset]; }
  SILT_DEVICE static void scatter(T* to, const Whole& offset, const Real& value) { to[offset] = value; }
};

}  // namespace silt::inline SILT_BUILD
