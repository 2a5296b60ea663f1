// The moments of a row of cells, and its totals, against sums over the directions, one cell after the other.
#include "lbm/moments.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>
#include <tuple>

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
    MomentArrays moments;
    for (const CellBox& box :
         {CellBox{{0, 2, 1}, {37, 1, 1}}, {{5, 2, 1}, {1, 1, 1}}, {{3, 0, 0}, {30, 3, 2}}}) {
      this->fluid.moments(0, box, moments);
      for (int k = 0; k < int(box.cells()); ++k) {
        const Int3 n = box.size;
        this->expect_equal(moments[k],
                           this->summed(box.lower + Int3{k % n.x, k / n.x % n.y, k / (n.x * n.y)}));
      }
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

/// Each cell's to the precision of its populations; and what many cells hold is what each of them does, to
/// the quantum.
TYPED_TEST(RowsOf, HaveTheTotalsOfTheirCells) {
  constexpr double near = 4 * double(std::numeric_limits<TypeParam>::epsilon());  // of sums of 19 up to 0.1
  this->set_at_random(11);
  for (const auto& [first, count, rows] : {std::tuple(0, 37, 3), {5, 1, 1}, {3, 30, 1}, {0, 16, 2}}) {
    const CellTotals found = this->fluid.totals(0, {{first, 0, 1}, count, rows});
    CellTotals sum;
    for (int cell = 0; cell < count * rows; ++cell) {
      const Int3 x{first + cell % count, cell / count, 1};
      const CellTotals t = this->fluid.totals(0, {x, 1});
      const Moments m = this->summed(x);
      const auto u = this->fluid.velocity(m);
      const double square = u[0] * u[0] + u[1] * u[1] + u[2] * u[2];
      EXPECT_NEAR(double(t.mass) * mass_quantum, m.density_deviation, near + mass_quantum);
      for (int d = 0; d < 3; ++d)
        EXPECT_NEAR(double(t.momentum[d]) * CellTotals::momentum_quantum, m.momentum[d], near + 4e-15);
      EXPECT_NEAR(double(t.energy) * CellTotals::energy_quantum +
                      double(t.energy_rest) * CellTotals::energy_rest_quantum,
                  square / 2, near);
      EXPECT_NEAR(t.speed_squared, square, near);
      EXPECT_NEAR(t.least_deviation, m.density_deviation, near);
      sum.mass += t.mass, sum.energy += t.energy, sum.energy_rest += t.energy_rest;
      for (int d = 0; d < 3; ++d) sum.momentum[d] += t.momentum[d];
      sum.speed_squared = std::max(sum.speed_squared, t.speed_squared);
      sum.least_deviation = std::min(sum.least_deviation, t.least_deviation);
      sum.most_deviation = std::max(sum.most_deviation, t.most_deviation);
    }
    EXPECT_TRUE(found.sound);
    EXPECT_EQ(found.mass, sum.mass);
    for (int d = 0; d < 3; ++d) EXPECT_EQ(found.momentum[d], sum.momentum[d]);
    EXPECT_EQ(found.energy, sum.energy);
    EXPECT_EQ(found.energy_rest, sum.energy_rest);
    EXPECT_EQ(found.speed_squared, sum.speed_squared);
    EXPECT_EQ(found.least_deviation, sum.least_deviation);
    EXPECT_EQ(found.most_deviation, sum.most_deviation);
  }
}

TYPED_TEST(RowsOf, HaveTheSameTotalsOnADevice) {
  const LocalRows rows[] = {{{0, 0, 1}, 37, 3}, {{5, 0, 0}, 1, 1}, {{3, 1, 0}, 30, 1}, {{0, 2, 1}, 16, 1}};
  for (const Device device : {Device::host, Device::gpu}) {
    if (!unusable(device).empty()) continue;
    for (const double wrong : {0., HUGE_VAL}) {
      this->set_at_random(17);
      this->fluid.arriving(0, {4, 1, 0}, 3) += TypeParam(wrong);
      Fluid<TypeParam> there(this->fluid.domain(), this->fluid.spec(), MPI_COMM_SELF, device);
      for_cells({}, this->cells, [&](Int3 x) {
        for (int i = 0; i < directions; ++i) there.arriving(0, x, i) = this->fluid.arriving(0, x, i);
      });
      const std::pmr::vector<LocalRows> listed(rows, std::end(rows), memory_of(device));
      std::pmr::vector<CellTotals> found(listed.size(), memory_of(device));
      std::pmr::vector<std::int64_t> masses(listed.size(), memory_of(device)), expected_masses(listed.size());
      there.totals(0, listed, found.data());
      there.masses(0, listed, masses.data()), this->fluid.masses(0, listed, expected_masses.data());
      for (std::size_t k = 0; k < listed.size(); ++k) {
        const CellTotals expected = this->fluid.totals(0, listed[k]), &is = found[k];
        EXPECT_EQ(is.sound, expected.sound);
        if (!is.sound) continue;
        EXPECT_EQ(masses[k], expected_masses[k]);
        EXPECT_EQ(is.mass, expected.mass);
        for (int d = 0; d < 3; ++d) EXPECT_EQ(is.momentum[d], expected.momentum[d]);
        EXPECT_EQ(is.energy, expected.energy);
        EXPECT_EQ(is.energy_rest, expected.energy_rest);
        EXPECT_EQ(is.speed_squared, expected.speed_squared);
        EXPECT_EQ(is.least_deviation, expected.least_deviation);
        EXPECT_EQ(is.most_deviation, expected.most_deviation);
      }
    }
  }
}

TYPED_TEST(RowsOf, WithACellThatIsNoFlowAreNotSound) {
  for (const double wrong : {std::nan(""), HUGE_VAL, -HUGE_VAL, 1e4, -1e4})
    for (const int cell : {0, 7, 36}) {
      this->set_at_random(13);
      this->fluid.arriving(0, {cell, 1, 0}, 3) = TypeParam(wrong);
      EXPECT_FALSE(this->fluid.totals(0, {{0, 1, 0}, 37}).sound) << wrong << " in cell " << cell;
      EXPECT_TRUE(this->fluid.totals(0, {{0, 0, 0}, 37}).sound);
    }
}

}  // namespace
}  // namespace silt::lbm
