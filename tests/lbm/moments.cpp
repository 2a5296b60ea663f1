// The moments of a row of cells against sums over the directions, one cell after the other.
#include "lbm/moments.hpp"

#include <gtest/gtest.h>

#include <random>

#include "lbm/fluid.hpp"

namespace silt::lbm {
namespace {

template <class T>
class RowsOf : public ::testing::Test {
 protected:
  static constexpr Int3 cells{37, 3, 2};
  Fluid<T> fluid{
      Domain(cells, {}, std::nullopt, 1), {0.8, 3. / 16, Collision::trt, {1e-4, 0, 0}}, MPI_COMM_SELF};

  void set_at_random(int seed) {
    std::mt19937 random(seed);
    std::uniform_real_distribution<> any(-0.1, 0.1);
    for (int z = 0; z < cells.z; ++z)
      for (int y = 0; y < cells.y; ++y)
        for (int x = 0; x < cells.x; ++x)
          for (int i = 0; i < directions; ++i) fluid.arriving(0, {x, y, z}, i) = T(any(random));
  }
  Moments summed(Int3 x) const {
    Moments m;
    constexpr int pairs[6][2] = {{0, 0}, {1, 1}, {2, 2}, {0, 1}, {0, 2}, {1, 2}};
    for (int i = 0; i < directions; ++i) {
      const double g = fluid.arriving(0, x, i);
      m.density_deviation += g;
      for (int d = 0; d < 3; ++d) m.momentum[d] += g * c[i][d];
      for (int k = 0; k < 6; ++k) m.flux[k] += g * c[i][pairs[k][0]] * c[i][pairs[k][1]];
    }
    return m;
  }
  static void expect_equal(const Moments& a, const Moments& b) {
    EXPECT_EQ(a.density_deviation, b.density_deviation);
    for (int d = 0; d < 3; ++d) EXPECT_EQ(a.momentum[d], b.momentum[d]);
    for (int k = 0; k < 6; ++k) EXPECT_EQ(a.flux[k], b.flux[k]);
  }
};

using Precisions = ::testing::Types<float, double>;
TYPED_TEST_SUITE(RowsOf, Precisions);

TYPED_TEST(RowsOf, ManyCellsHaveTheMomentsOfEachToTheBitInBothParities) {
  for (int pass = 0; pass < 2; ++pass) {
    this->set_at_random(pass);
    MomentsRow row;
    for (const auto& [first, count] : {std::pair(0, 37), std::pair(5, 1), std::pair(3, 30)}) {
      this->fluid.moments(0, {first, 2, 1}, count, row);
      for (int k = 0; k < count; ++k) this->expect_equal(row[k], this->summed({first + k, 2, 1}));
    }
    this->fluid.stream_collide(), this->fluid.exchange();
  }
}

TYPED_TEST(RowsOf, AreSummedAnewWhenAnotherRowIsAskedFor) {
  this->set_at_random(7);
  MomentsByRow moments(this->fluid, 0, 4, 30);
  for (const Int3 cell : {Int3{4, 0, 0}, Int3{29, 0, 0}, Int3{4, 1, 0}, Int3{12, 0, 1}, Int3{13, 0, 0}})
    this->expect_equal(moments(cell), this->summed(cell));
}

}  // namespace
}  // namespace silt::lbm
