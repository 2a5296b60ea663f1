#pragma once
// Sums that do not depend on their order: each term is rounded once to a whole number of quanta and added as
// an integer. Used for whatever is summed over ranks or in a varying order.
#include <array>
#include <cmath>
#include <stdexcept>

#include "rigid/math/types.hpp"

namespace silt::rigid {

/// A sum in quanta of 2^-64, range +-2^63 (lattice units of force or torque).
using FixedSum = __int128;

/// Rounds x to a whole number of quanta (exact scaling, truncation of the last bit). |x| < 2^62, finite:
/// else std::overflow_error.
inline FixedSum to_fixed(double x) {
  if (!(std::abs(x) < 0x1p62)) throw std::overflow_error("a force or torque is not finite or above 2^62");
  return static_cast<FixedSum>(x * 0x1p64);
}
inline double from_fixed(FixedSum q) {
  return static_cast<double>(q) / 0x1p64;
}

struct FixedVec3 {
  std::array<FixedSum, 3> q{};
  void add(const Vec3& v) {
    for (int d = 0; d < 3; ++d) q[d] += to_fixed(v[d]);
  }
  void add(const FixedVec3& o) {
    for (int d = 0; d < 3; ++d) q[d] += o.q[d];
  }
  bool is_zero() const { return (q[0] | q[1] | q[2]) == 0; }
  Vec3 value() const { return {from_fixed(q[0]), from_fixed(q[1]), from_fixed(q[2])}; }
};

}  // namespace silt::rigid
