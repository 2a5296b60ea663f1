#pragma once
// Sums that do not depend on the order of their terms, for all that is summed over ranks or in a varying
// order. FixedSum rounds each term to a whole number of quanta and adds integers; ExactSum rounds once, at
// the end, whatever the terms' sizes (Kulisch, Computer Arithmetic and Validity, 2008, chapter 8, with a
// shorter accumulator).
#include <array>
#include <cmath>
#include <cstdint>
#include <span>
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

/// A whole number of quanta of 2^-256 in digits of 32 bits, lowest first. Terms are cut off below a quantum;
/// one that is not finite or not below 2^192 makes the sum NaN.
class ExactSum {
 public:
  static constexpr int width = 17;  // of parts(): the digits, and how many terms were out of range

  /// Adds a term; at most 2^30 may be added between two calls of carry.
  void add(double);
  /// Adds so many quanta; a quantum is a power of two.
  void add(FixedSum quanta, double quantum);

  /// Brings all digits but the highest into [0, 2^32).
  void carry();
  /// Integers whose sums over the ranks are the parts of the sum: at most 2^30 ranks, each after carry.
  std::span<std::int64_t, width> parts() { return parts_; }
  std::span<const std::int64_t, width> parts() const { return parts_; }

  /// Returns the sum, rounded to the nearest double.
  double value() const;

 private:
  static constexpr int digits = width - 1, lowest = -256;  // exponent of the first digit
  std::array<std::int64_t, width> parts_{};
};

}  // namespace silt::rigid
