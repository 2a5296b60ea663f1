#pragma once
// Sums that do not depend on the order of their terms, for sums over ranks or over lists of varying order.
// FixedSum rounds each term to an integer number of quanta; ExactSum rounds once, at the end, for terms of
// any size (Kulisch, Computer Arithmetic and Validity, 2008, chapter 8, with a shorter accumulator).
#include <array>
#include <cmath>
#include <cstdint>
#include <span>
#include <stdexcept>

#include "rigid/math/types.hpp"

namespace silt::rigid {

/// A sum in quanta of 2^-64, with the range +-2^63 (lattice units of force or torque).
using FixedSum = __int128;

/// Returns x in quanta, truncated. Throws std::overflow_error unless |x| < 2^62.
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

/// An integer number of quanta of 2^-256, in digits of 32 bits, lowest first. Each term is truncated to whole
/// quanta; a term that is not finite or not below 2^192 makes the sum NaN.
class ExactSum {
 public:
  static constexpr int width = 17;  // of parts(): 16 digits and the number of terms out of range

  /// Adds a term. At most 2^30 terms may be added between two calls of carry().
  void add(double);
  /// Adds a number of quanta of the given size, a power of two.
  void add(FixedSum quanta, double quantum);

  /// Normalises all digits but the highest to [0, 2^32).
  void carry();
  /// Returns the integers to be summed over ranks: at most 2^30 ranks, each after carry().
  std::span<std::int64_t, width> parts() { return parts_; }
  std::span<const std::int64_t, width> parts() const { return parts_; }

  /// Returns the sum, rounded to the nearest double.
  double value() const;

 private:
  static constexpr int digits = width - 1, lowest = -256;  // exponent of the first digit
  std::array<std::int64_t, width> parts_{};
};

}  // namespace silt::rigid
