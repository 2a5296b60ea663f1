// When something counts as steady: against series whose end is known.
#include "silt/results/steady_watch.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>

namespace silt::testing {
namespace {

constexpr int never = 1 << 20;

/// The look (from 1 on) at which value(look) is found steady.
template <class Value>
int steady_at(double change, Value&& value, int most = 100000) {
  SteadyWatch watch(change);
  for (int n = 1; n <= most; ++n) {
    watch.look(value(n));
    if (watch.steady()) return n;
  }
  return never;
}

/// However slow or fast the approach: what is missing at the end is at most what was asked for, and the run
/// is not much longer than it need be.
TEST(SteadyWatch, StopsWhenSoMuchIsLeftOfAGeometricApproach) {
  for (const double ratio : {0.1, 0.5, 0.9, 0.98})
    for (const double change : {1e-2, 1e-4, 1e-6}) {
      const auto value = [&](int n) { return 3 * (1 - 0.7 * std::pow(ratio, n)); };
      const int end = steady_at(change, value);
      const double needed = std::log(change / 0.7) / std::log(ratio);
      EXPECT_LE(std::abs(value(end) / 3 - 1), 1.01 * change) << ratio << " " << change;
      EXPECT_LE(end, needed + 4) << ratio << " " << change;
    }
}

/// A drift of 1e-5 a look that goes on for ever is not steady to 1e-4, though each change is smaller.
TEST(SteadyWatch, ASteadyDriftIsNotSteady) {
  EXPECT_EQ(steady_at(
                1e-4, [](int n) { return 1 + 1e-5 * n; }, 8000),
            never);
}

/// Diffusion that begins: sums of exponentials, the fast ones first.
TEST(SteadyWatch, AFastApproachHidesNoSlowOne) {
  const auto value = [](int n) { return 1 - 0.9 * std::pow(0.3, n) - 0.1 * std::pow(0.97, n); };
  EXPECT_LE(std::abs(value(steady_at(1e-3, value)) - 1), 1.01e-3);
}

/// Swings that fade: it stands still at every turn.
TEST(SteadyWatch, TurningPointsAreNotTheEnd) {
  for (const double period : {3.1, 4.7, 9.3}) {
    const auto swing = [&](int n) {
      return 1 + std::pow(0.9, n) * std::cos(2 * std::numbers::pi * n / period);
    };
    const int end = steady_at(1e-3, swing);
    double left = 0;  // the largest swing still to come
    for (int n = end; n < end + 30; ++n) left = std::max(left, std::abs(swing(n) - 1));
    EXPECT_LE(left, 2.5e-3) << period;
  }
}

/// Rounding in the last digits neither keeps it from ending nor ends it early.
TEST(SteadyWatch, Rounding) {
  const auto rounded = [](int n) { return std::round(1e7 * (1 - std::pow(0.8, n))) * 1e-7; };
  const int end = steady_at(1e-5, rounded);
  EXPECT_LE(std::abs(rounded(end) - 1), 1.1e-5);
  EXPECT_LT(end, 80);
}

TEST(SteadyWatch, NothingHappens) {
  EXPECT_EQ(steady_at(1e-6, [](int) { return 0.; }), 4);
  EXPECT_EQ(steady_at(1e-6, [](int) { return 5.; }), 4);
  EXPECT_EQ(steady_at(
                1e-6, [](int) { return std::numeric_limits<double>::quiet_NaN(); }, 100),
            never);
}

TEST(SteadyWatch, GoesOnFromItsState) {
  const auto value = [](int n) { return 1 - std::pow(0.7, n); };
  const int end = steady_at(1e-4, value);
  for (int stop = 0; stop <= end; ++stop) {
    SteadyWatch first(1e-4), second(1e-4);
    for (int n = 1; n <= stop; ++n) first.look(value(n));
    second.set_state(first.state());
    int n = stop;
    while (!second.steady()) second.look(value(++n));
    EXPECT_EQ(n, end);
  }
}

}  // namespace
}  // namespace silt::testing
