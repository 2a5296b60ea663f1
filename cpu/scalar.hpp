#pragma once
// Vectors of one lane: plain numbers, for kernels that are built for a device (SILT_SCALAR).
#include <cmath>

#include "cpu/device_code.hpp"

namespace silt::inline SILT_ISA {

template <class V>
SILT_DEVICE inline V load(const V* from) {
  return *from;
}
template <class V>
SILT_DEVICE inline void store(V* to, const V& v) {
  *to = v;
}
SILT_DEVICE inline bool any_lane(bool lane) {
  return lane;
}

}  // namespace silt::inline SILT_ISA
