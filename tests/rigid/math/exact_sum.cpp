// Exact sums against integers, whatever the order and the size of their terms.
#include "rigid/math/exact_sum.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>
#include <vector>

namespace silt::rigid {
namespace {

double sum_of(const std::vector<double>& terms) {
  ExactSum sum;
  for (const double x : terms) sum.add(x);
  return sum.value();
}

TEST(ExactSum, OfIntegersIsTheirSumRounded) {
  std::mt19937_64 random(1);
  for (int trial = 0; trial < 1000; ++trial) {
    std::vector<double> terms;
    __int128 exact = 0;
    for (int i = 0; i < 20; ++i) {
      const std::int64_t bits = std::int64_t(random()) >> (11 + random() % 50);
      const int shift = int(random() % 60);
      terms.push_back(std::ldexp(double(bits), shift));
      exact += __int128(bits) << shift;
    }
    EXPECT_EQ(sum_of(terms), double(exact));
    const int scale = int(random() % 250) - 180;
    for (double& x : terms) x = std::ldexp(x, scale);
    std::shuffle(terms.begin(), terms.end(), random);
    EXPECT_EQ(sum_of(terms), std::ldexp(double(exact), scale));
  }
}

TEST(ExactSum, LosesNothingBesideLargeTerms) {
  EXPECT_EQ(sum_of({1e50, 1e-50, -1e50}), 1e-50);
  EXPECT_EQ(sum_of({1, 0x1p-53}), 1) << "a tie goes to the even one";
  EXPECT_EQ(sum_of({1, 0x1p-53, 0x1p-200}), 1 + 0x1p-52) << "and the least bit decides";
  EXPECT_EQ(sum_of({-1, -0x1p-53, -0x1p-200}), -1 - 0x1p-52);
  EXPECT_EQ(sum_of({}), 0);
}

TEST(ExactSum, OfQuantaAndOfParts) {
  const FixedSum quanta = -((FixedSum(1) << 100) + 12345);
  ExactSum sum, all;
  sum.add(quanta, 0x1p-44);
  sum.add(0x1p56);
  EXPECT_EQ(sum.value(), -12345 * 0x1p-44);
  for (int rank = 0; rank < 3; ++rank) {
    sum.carry();
    for (int k = 0; k < ExactSum::width; ++k) all.parts()[k] += sum.parts()[k];
  }
  EXPECT_EQ(all.value(), -3 * 12345 * 0x1p-44);
}

TEST(ExactSum, OfWhatIsOutOfRangeIsNotANumber) {
  EXPECT_TRUE(std::isnan(sum_of({1, std::numeric_limits<double>::quiet_NaN()})));
  EXPECT_TRUE(std::isnan(sum_of({std::numeric_limits<double>::infinity()})));
  EXPECT_TRUE(std::isnan(sum_of({-0x1p192, 1})));
  EXPECT_EQ(sum_of({0x1p191, 0x1p191}), 0x1p192);
  EXPECT_EQ(sum_of({0x1p-300, 3}), 3);
}

}  // namespace
}  // namespace silt::rigid
