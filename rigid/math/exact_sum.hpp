#pragma once
// Sums of doubles that are rounded once, at their end: they do not depend on the order of their terms,
// whatever the terms' sizes (Kulisch, Computer Arithmetic and Validity, 2008, chapter 8, with a shorter
// accumulator).
#include <array>
#include <cstdint>
#include <span>

#include "rigid/math/fixed_point.hpp"

namespace silt::rigid {

/// A whole number of quanta of 2^-256 in digits of 32 bits, lowest first. Terms are cut off below a quantum;
/// one that is not finite or not below 2^192 makes the sum NaN.
class ExactSum {
 public:
  static constexpr int width = 17;  // of parts(): the digits, and how many terms were out of range

  /// At most 2^30 times between two calls of carry.
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
