#pragma once
// Rows of cells in the dense passes of the fluid and of the temperature. Only for files built for a device or
// an instruction set (SILT_BUILD).

#include "cpu/lanes.hpp"
#include "lbm/blocks/block.hpp"

namespace silt::lbm::SILT_BUILD {

struct AllLanes {
  template <class V>
  SILT_DEVICE const V& operator()(const V& inner, const V&) const {
    return inner;
  }
};

#if !defined(SILT_SCALAR)
/// Masks the lanes of a vector beyond the first `cells`.
template <class V, class T>
struct FirstLanes {
  static constexpr int count = sizeof(V) / sizeof(T);
  decltype(V{} < V{}) inside;
  explicit FirstLanes(std::ptrdiff_t cells) {
    V lane;
    for (int i = 0; i < count; ++i) lane[i] = T(i);
    inside = lane < (V{} + T(cells));
  }
  template <class Vector>  // with lanes as wide as those of V
  Vector operator()(const Vector& inner, const Vector& outer) const {
    return inside ? inner : outer;
  }
};
#endif

}  // namespace silt::lbm::SILT_BUILD
