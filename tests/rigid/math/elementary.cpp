#include "rigid/math/elementary.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <numbers>
#include <random>

namespace silt::rigid::elementary {
namespace {

using Exact = long double;  // of 64 bits or more: its functions are far better than what they judge

double ulp(double x) {
  return std::nextafter(std::abs(x), std::numeric_limits<double>::infinity()) - std::abs(x);
}

/// Returns the largest error of f in 300 000 numbers of a range, in units of `unit` of the exact value.
double worst(double low, double high, const std::function<double(double)>& f,
             const std::function<Exact(Exact)>& exact, const std::function<double(double, double)>& unit) {
  std::mt19937_64 g(7);
  double found = 0;
  for (int i = 0; i < 300000; ++i) {
    const double x = std::uniform_real_distribution<>(low, high)(g);
    const Exact right = exact(x);
    const Exact error = std::abs(f(x) - right) / unit(x, double(right));
    found = std::max(found, error == error ? double(error) : INFINITY);
  }
  return found;
}
double of_result(double, double right) {
  return ulp(right);
}

TEST(Elementary, SineAndCosine) {
  const auto sine = [](Exact x) { return std::sin(x); };
  const auto cosine = [](Exact x) { return std::cos(x); };
  for (const double reach : {1e-8, 1e-3, 1.0}) {
    EXPECT_LT(worst(-reach, reach, sin, sine, of_result), 1.2) << reach;
    EXPECT_LT(worst(-reach, reach, cos, cosine, of_result), 1.2) << reach;
  }
  const auto of_argument = [](double x, double) { return 0x1p-53 * (1 + 0x1p-30 * std::abs(x)); };
  for (const double reach : {4.0, 100.0, 1e6, 1e9}) {
    EXPECT_LT(worst(-reach, reach, sin, sine, of_argument), 1.5) << reach;
    EXPECT_LT(worst(-reach, reach, cos, cosine, of_argument), 1.5) << reach;
  }
}

TEST(Elementary, AnglesInEveryQuadrant) {
  for (const double across : {1e-9, 0.1, 1.0, 3.0, 1e9}) {
    const auto exact = [&](Exact y) { return std::atan2(y, Exact(across)); };
    const auto behind = [&](Exact y) { return std::atan2(y, -Exact(across)); };
    EXPECT_LT(worst(
                  -3, 3, [&](double y) { return atan2(y, across); }, exact, of_result),
              5)
        << across;
    EXPECT_LT(worst(
                  -3, 3, [&](double y) { return atan2(y, -across); }, behind, of_result),
              5)
        << across;
  }
  EXPECT_EQ(atan2(0, 0), 0);
  EXPECT_EQ(atan2(0, -1), std::numbers::pi);
  EXPECT_EQ(atan2(-1, 0), -std::numbers::pi / 2);
}

TEST(Elementary, LogarithmExponentialAndRoots) {
  for (const auto& [low, high] : {std::pair(1e-9, 1e-6), {0.1, 0.9}, {0.9, 1.1}, {1.1, 10.0}, {1e3, 1e30}})
    EXPECT_LT(worst(
                  low, high, log, [](Exact x) { return std::log(x); }, of_result),
              2)
        << low;
  for (const double reach : {1e-3, 1.0, 30.0, 700.0})
    EXPECT_LT(worst(
                  -reach, reach, exp, [](Exact x) { return std::exp(x); }, of_result),
              1)
        << reach;
  const auto quantum = [](double, double) { return 0x1p-52; };
  for (const double reach : {1e-6, 1.0, 30.0})
    EXPECT_LT(worst(
                  -reach, reach, tanh, [](Exact x) { return std::tanh(x); }, quantum),
              1)
        << reach;
  for (const double reach : {1e-9, 1.0, 1e20})
    EXPECT_LT(worst(
                  -reach, reach, cbrt, [](Exact x) { return std::cbrt(x); }, of_result),
              1)
        << reach;
  for (const double other : {0.0, 1e-3, 1.0})
    EXPECT_LT(worst(
                  -2, 2, [&](double x) { return hypot(x, other); },
                  [&](Exact x) { return std::sqrt(x * x + Exact(other) * other); }, of_result),
              1.2);
  EXPECT_LT(
      worst(
          0.5, 2, [](double x) { return power(x, -3); }, [](Exact x) { return 1 / (x * x * x); }, of_result),
      3);
  EXPECT_EQ(power(3, 0), 1);
  EXPECT_EQ(power(3, 4), 81);
}

TEST(Elementary, Ends) {
  constexpr double inf = std::numeric_limits<double>::infinity();
  EXPECT_EQ(exp(1000), inf);
  EXPECT_EQ(exp(-1000), 0);
  EXPECT_EQ(exp(0), 1);
  EXPECT_TRUE(std::isnan(exp(NAN)));
  EXPECT_EQ(log(1), 0);
  EXPECT_EQ(log(0), -inf);
  EXPECT_TRUE(std::isnan(log(-1)));
  EXPECT_EQ(cbrt(0), 0);
  EXPECT_EQ(cbrt(-27), -3);
  EXPECT_EQ(sin(0), 0);
  EXPECT_EQ(cos(0), 1);
}

}  // namespace
}  // namespace silt::rigid::elementary
