#include "rigid/math/exact_sum.hpp"

#include <bit>
#include <limits>

namespace silt::rigid {
namespace {
constexpr double too_large = 0x1p192;
constexpr std::int64_t digit_mask = 0xffffffff;
}  // namespace

void ExactSum::add(double x) {
  if (!(std::abs(x) < too_large)) {
    ++parts_[digits];
    return;
  }
  constexpr int mantissa_bits = 52, exponent_of_one = 1023;
  const auto word = std::bit_cast<std::uint64_t>(std::abs(x));
  // A normal x is bits * 2^(lowest + at). Those below 2^-1022 are less than a quantum, with these bits, too.
  std::uint64_t bits = (word & ((std::uint64_t{1} << mantissa_bits) - 1)) | std::uint64_t{1} << mantissa_bits;
  int at = int(word >> mantissa_bits) - exponent_of_one - mantissa_bits - lowest;
  if (at < 0) {
    bits = at > -64 ? bits >> -at : 0;
    at = 0;
  }
  auto rest = static_cast<unsigned __int128>(bits) << (at % 32);
  for (int k = at / 32; rest != 0; ++k, rest >>= 32) {
    const auto digit = static_cast<std::int64_t>(static_cast<std::uint32_t>(rest));
    parts_[k] += x < 0 ? -digit : digit;
  }
}

void ExactSum::add(FixedSum quanta, double quantum) {
  auto rest = static_cast<unsigned __int128>(quanta < 0 ? -quanta : quanta);
  for (double unit = quanta < 0 ? -quantum : quantum; rest != 0; rest >>= 32, unit *= 0x1p32)
    add(unit * static_cast<std::uint32_t>(rest));
}

void ExactSum::carry() {
  for (int k = 0; k + 1 < digits; ++k) {
    parts_[k + 1] += parts_[k] >> 32;
    parts_[k] &= digit_mask;
  }
}

double ExactSum::value() const {
  if (parts_[digits] != 0) return std::numeric_limits<double>::quiet_NaN();
  ExactSum magnitude = *this;
  magnitude.carry();
  const bool negative = magnitude.parts_[digits - 1] < 0;
  if (negative) {
    for (int k = 0; k < digits; ++k) magnitude.parts_[k] = -magnitude.parts_[k];
    magnitude.carry();
  }
  int top = digits - 1;
  while (top > 2 && magnitude.parts_[top] == 0) --top;
  // Three digits hold more than a double does; of the others only matters whether any is nonzero.
  unsigned __int128 leading = 0;
  for (int k = top; k > top - 3; --k)
    leading = leading << 32 | static_cast<unsigned __int128>(magnitude.parts_[k]);
  for (int k = 0; k <= top - 3; ++k) leading |= magnitude.parts_[k] != 0;
  const double value = std::ldexp(static_cast<double>(leading), 32 * (top - 2) + lowest);
  return negative ? -value : value;
}

}  // namespace silt::rigid
