#include "rigid/math/elementary.hpp"

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <limits>
#include <numbers>

namespace silt::rigid::elementary {
namespace {

/// Evaluates c[0] + x (c[1] + x (c[2] + ...)).
template <std::size_t terms>
double series(const std::array<double, terms>& c, double x) {
  double sum = c[terms - 1];
  for (std::size_t k = terms - 1; k-- > 0;) sum = c[k] + x * sum;
  return sum;
}

/// Returns +-1 / n! for n = first, first + 2, ..., with alternating signs, the first positive.
template <std::size_t terms>
constexpr std::array<double, terms> alternating_factorials(int first) {
  std::array<double, terms> c{};
  double factorial = 1;  // exact to 18!
  int n = 1;
  for (std::size_t k = 0; k < terms; ++k) {
    for (; n <= first + 2 * int(k); ++n) factorial *= n;
    c[k] = (k % 2 ? -1 : 1) / factorial;
  }
  return c;
}

template <std::size_t terms>
constexpr std::array<double, terms> factorials(int first) {
  std::array<double, terms> c{};
  double factorial = 1;
  int n = 1;
  for (std::size_t k = 0; k < terms; ++k) {
    for (; n <= first + int(k); ++n) factorial *= n;
    c[k] = 1 / factorial;
  }
  return c;
}

/// Returns 1 / first, 1 / (first + 2), ..., optionally with alternating signs.
template <std::size_t terms>
constexpr std::array<double, terms> odd_reciprocals(int first, bool alternating) {
  std::array<double, terms> c{};
  for (std::size_t k = 0; k < terms; ++k) c[k] = (alternating && k % 2 ? -1. : 1.) / (first + 2 * int(k));
  return c;
}

// Taylor series for |x| <= pi/4; the truncation error is below 2^-57 of the sum.
double sin_near_zero(double x) {
  static constexpr auto c = alternating_factorials<8>(3);
  const double square = x * x;
  return x - x * square * series(c, square);
}
double cos_near_zero(double x) {
  static constexpr auto c = alternating_factorials<7>(4);
  const double square = x * x, half = 0.5 * square, rounded = 1 - half;
  return rounded + ((1 - rounded - half) + square * square * series(c, square));
}

/// An angle reduced by the nearest multiple of pi/2, and that multiple modulo 4.
struct ReducedAngle {
  double angle;
  int quarters;
};

ReducedAngle reduced(double x) {
  // pi/2 as a sum: three parts of 22 bits, whose products with n < 2^30 are exact, and the remainder.
  constexpr double parts[] = {0x1.921fb0p+0, 0x1.5110b0p-22, 0x1.184698p-44, 0x1.3198a2e037073p-69};
  if (std::abs(x) <= std::numbers::pi / 4) return {x, 0};
  const double n = std::floor(x / (std::numbers::pi / 2) + 0.5);
  double angle = x;
  for (const double part : parts) angle -= n * part;
  return {angle, int(std::int64_t(n) & 3)};
}

double sine_of(const ReducedAngle& q) {
  const double value = q.quarters % 2 ? cos_near_zero(q.angle) : sin_near_zero(q.angle);
  return q.quarters < 2 ? value : -value;
}

/// atan t for 0 <= t <= 1; halves the angle twice, to at most pi/16.
double atan_below_one(double t) {
  static constexpr auto c = odd_reciprocals<12>(3, true);
  for (int halving = 0; halving < 2; ++halving) t = t / (1 + std::sqrt(1 + t * t));
  const double square = t * t;
  return 4 * (t - t * square * series(c, square));
}

constexpr double ln2_high = 0x1.62e42feep-1, ln2_low = 0x1.a39ef35793c76p-33;  // n * ln2_high is exact

}  // namespace

double sin(double x) {
  return sine_of(reduced(x));
}

double cos(double x) {
  ReducedAngle q = reduced(x);
  q.quarters = (q.quarters + 1) & 3;
  return sine_of(q);
}

double atan2(double y, double x) {
  const double a = std::abs(x), b = std::abs(y);
  if (a == 0 && b == 0) return 0;
  double angle = b <= a ? atan_below_one(b / a) : std::numbers::pi / 2 - atan_below_one(a / b);
  if (x < 0) angle = std::numbers::pi - angle;
  return y < 0 ? -angle : angle;
}

double log(double x) {
  static constexpr auto c = odd_reciprocals<11>(3, false);
  int exponent = 0;
  double m = std::frexp(x, &exponent);  // 1/2 <= m < 1
  if (!(x > 0) || !std::isfinite(x))
    return x == 0 ? -std::numeric_limits<double>::infinity() : x > 0 ? x : NAN;
  if (m < std::numbers::sqrt2 / 2) m *= 2, --exponent;
  const double from_one = m - 1, s = from_one / (2 + from_one), square = s * s;
  // 2 atanh s = (m - 1) - s (m - 1 - 2 s^2 (1/3 + s^2/5 + ...))
  const double of_m = from_one - s * (from_one - 2 * square * series(c, square));
  return exponent * ln2_high + (exponent * ln2_low + of_m);
}

double exp(double x) {
  static constexpr auto c = factorials<13>(2);
  if (!(x < 709.78)) return x > 0 ? std::numeric_limits<double>::infinity() : x;
  if (x < -708.39) return 0;
  const double n = std::floor(x / std::numbers::ln2 + 0.5);
  const double high = x - n * ln2_high, low = n * ln2_low, r = high - low;
  const double rest = r * r * series(c, r) + ((high - r) - low);
  return std::ldexp(1 + (r + rest), int(n));
}

double tanh(double x) {
  const double e = exp(-2 * std::abs(x));
  return std::copysign((1 - e) / (1 + e), x);
}

double cbrt(double x) {
  if (x == 0 || !std::isfinite(x)) return x;
  int exponent = 0;
  double m = std::frexp(std::abs(x), &exponent);
  while (exponent % 3 != 0) m *= 0.5, ++exponent;  // 1/8 <= m < 1
  double y = 0.38 + 0.66 * m;
  for (int round = 0; round < 5; ++round) y -= (y * y * y - m) / (3 * y * y);  // Newton's method
  return std::ldexp(x < 0 ? -y : y, exponent / 3);
}

double hypot(double x, double y) {
  return std::sqrt(x * x + y * y);
}

double power(double x, int n) {
  double product = 1;
  for (int k = 0; k < std::abs(n); ++k) product *= x;
  return n < 0 ? 1 / product : product;
}

}  // namespace silt::rigid::elementary
