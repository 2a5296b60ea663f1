#pragma once
// Adds the contribution of links to the resistance of a surface (method.md, equation 23): a vector of links
// at a time, or one (SILT_SCALAR).
#include "lbm/walls/link_places.hpp"

namespace silt::lbm::SILT_BUILD {

inline constexpr int resistance_entries = 21, push_entries = 6;

/// Calls add(e, terms) for the entries of 6 w J J^T and then of 6 w J (ResistanceSums), in quanta; arms are
/// multiplied by `arm`.
template <class T, class Add, class V = typename Lanes<T>::Real>
[[gnu::always_inline]] SILT_DEVICE inline void add_resistance(const Places<T>& at,
                                                              const typename Lanes<T>::Mask& counted, T arm,
                                                              Add&& add) {
  const V weight = counted ? at.weight6() * T(1 / resistance_quantum<T>) : V{};
  const V x = at.r[0] * arm, y = at.r[1] * arm, z = at.r[2] * arm;
  const auto& c = at.c;
  const V j[6] = {c[0], c[1], c[2], y * c[2] - z * c[1], z * c[0] - x * c[2], x * c[1] - y * c[0]};
  int e = 0;
  for (int a = 0; a < 6; ++a) {
    const V wj = weight * j[a];
    for (int b = a; b < 6; ++b, ++e) add(e, wj * j[b]);
    add(resistance_entries + a, wj);
  }
}

}  // namespace silt::lbm::SILT_BUILD
