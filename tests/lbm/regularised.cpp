// Single cells and rows of cells: the collision model regularised, and the moments of rows and their totals,
// against sums over the directions.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <random>
#include <tuple>

#include "lbm/blocks/moments.hpp"
#include "lbm/collision/collision_model.hpp"
#include "lbm/collision/stream_collide.hpp"
#include "lbm/fluid.hpp"

namespace silt::lbm {
namespace {

using Vector = std::array<double, 3>;
using Tensor = std::array<Vector, 3>;
using Populations = std::array<double, D3Q19::directions>;

constexpr double rounding = 1e-15;  // populations are of the size of 0.01

double delta(int a, int b) {
  return a == b;
}
double along(int i, int d) {
  return D3Q19::c[i][d];
}
double third_order(int i, int a, int b, int e) {
  return along(i, a) * along(i, b) * along(i, e) -
         (along(i, a) * delta(b, e) + along(i, b) * delta(a, e) + along(i, e) * delta(a, b)) / 3;
}

/// The six combinations of H_abb that the lattice carries, orthogonal under the weights: sums and
/// differences.
template <class A>
double third_order_part(int i, A&& moment) {
  double sum = 0;
  for (int b = 0; b < 3; ++b) {
    const int a = (b + 1) % 3, e = (b + 2) % 3;
    const double h_a = third_order(i, a, a, b), h_e = third_order(i, e, e, b);
    const double m_a = moment(a, a, b), m_e = moment(e, e, b);
    sum += 3 * (h_a + h_e) * (m_a + m_e) + (h_a - h_e) * (m_a - m_e);
  }
  return 4.5 * sum;
}

/// Returns the relaxation time at which the eddy viscosity (C^2 |S|, |S|^2 = 2 S : S, S = -3 off / (2 tau))
/// is that of the collision, by bisection.
double eddy_relaxation_time(const Tensor& off, double constant) {
  double square = 0;
  for (const Vector& row : off)
    for (const double x : row) square += x * x;
  double low = 0.5, high = 5;
  for (int i = 0; i < 60; ++i) {
    const double tau = (low + high) / 2, rate = std::sqrt(2 * square) * 1.5 / tau;
    (3 * constant * constant * rate > tau - 0.5 ? low : high) = tau;
  }
  return low;
}

/// Returns what g becomes: the equilibrium to third order with the stress off it relaxed, its trace at once,
/// and what follows from it in the third moments (Malaspinas, arXiv:1505.06900); what else is in those
/// relaxed with 1/tau_odd; Guo's force.
Populations regularised(const Populations& g, const CollisionSpec& spec) {
  const Vector& force = spec.force;
  double rho = 0;
  Vector u{};
  Tensor off{};  // the stress off equilibrium, without its trace
  for (int i = 0; i < D3Q19::directions; ++i) {
    rho += g[i];
    for (int d = 0; d < 3; ++d) u[d] += along(i, d) * g[i];
  }
  for (int d = 0; d < 3; ++d) u[d] += force[d] / 2;
  for (int a = 0; a < 3; ++a)
    for (int b = 0; b < 3; ++b) {
      for (int i = 0; i < D3Q19::directions; ++i)
        off[a][b] += (along(i, a) * along(i, b) - delta(a, b) / 3) * g[i];
      off[a][b] -= u[a] * u[b];
    }
  const double trace = (off[0][0] + off[1][1] + off[2][2]) / 3;
  for (int d = 0; d < 3; ++d) off[d][d] -= trace;
  const double tau = std::max(spec.relaxation_time, eddy_relaxation_time(off, spec.smagorinsky));
  const double keep = 1 - 1 / tau, keep_third = 1 - 1 / spec.odd_relaxation_time();

  const auto power = [&](int a, int b) { return u[a] * force[b] + u[b] * force[a]; };
  const double mean_power = (power(0, 0) + power(1, 1) + power(2, 2)) / 3;
  const auto second = [&](int a, int b) {
    return u[a] * u[b] + keep * off[a][b] + (1 + keep) / 2 * (power(a, b) - delta(a, b) * mean_power) +
           delta(a, b) * mean_power / 2;
  };
  const auto third = [&](int a, int b, int e) {
    double sum = 0;
    for (int i = 0; i < D3Q19::directions; ++i) sum += keep_third * third_order(i, a, b, e) * g[i];
    const auto follows = [&](int d, int x, int y) {
      return u[d] * ((keep - keep_third) * off[x][y] - keep_third * delta(x, y) * trace);
    };
    return sum + (1 - keep_third) * u[a] * u[b] * u[e] + follows(a, b, e) + follows(b, a, e) +
           follows(e, a, b);
  };
  Populations even;  // what is of fourth order: the even halves less what rho and second moments say of them
  for (int i = 0; i < D3Q19::directions; ++i) {
    double sum = rho;
    for (int a = 0; a < 3; ++a)
      for (int b = 0; b < 3; ++b)
        sum += 4.5 * (along(i, a) * along(i, b) - delta(a, b) / 3) *
               (off[a][b] + delta(a, b) * trace + u[a] * u[b]);
    even[i] = (g[i] + g[opposite(i)]) / 2 - D3Q19::w(i) * sum;
  }
  const double keep_fourth = (1 - 1 / spec.relaxation_time) * spec.ghosts_as_trt();
  Populations after;
  for (int i = 0; i < D3Q19::directions; ++i) {
    double sum = rho;
    for (int a = 0; a < 3; ++a) {
      sum += 3 * along(i, a) * (u[a] + force[a] / 2);
      for (int b = 0; b < 3; ++b) sum += 4.5 * (along(i, a) * along(i, b) - delta(a, b) / 3) * second(a, b);
    }
    after[i] = D3Q19::w(i) * (sum + third_order_part(i, third)) + keep_fourth * even[i];
  }
  return after;
}

void expect_definition(const CollisionSpec& spec) {
  std::mt19937_64 random(7);
  std::uniform_real_distribution<double> uniform(-0.01, 0.01);
  const Int3 size{5, 3, 2};
  for (const Parity parity : {Parity::settled, Parity::crossed}) {
    Block<double> block({{0, 0, 0}, size});
    CollisionRates<double> rates(spec);
    const Int3 x{3, 1, 1};
    Populations before;
    for (int i = 0; i < D3Q19::directions; ++i)
      block.data()[block.arriving(i, parity) + block.cell(x)] = before[i] = uniform(random);
    std::vector<FastCell> fast;
    stream_collide(block, parity, rates, {0, size.y, 0, size.z}, {0, fast});
    const Populations expected = regularised(before, spec);
    for (int i = 0; i < D3Q19::directions; ++i)
      EXPECT_NEAR(block.data()[block.leaving(i, flipped(parity)) + block.cell(x)], expected[i], rounding)
          << i;
  }
}
constexpr CollisionSpec of(double tau, Vector force = {}, double smagorinsky = 0) {
  return {tau, 0.15, Collision::regularised, force, smagorinsky};
}

TEST(Regularised, IsItsDefinition) {
  for (const double tau : {0.5001, 0.57, 0.6, 1., 3.}) expect_definition(of(tau));
}
TEST(Regularised, TakesAForce) {
  for (const double tau : {0.5001, 0.57, 0.9}) expect_definition(of(tau, {1e-3, -2e-3, 5e-4}));
}

TEST(Regularised, IsAtLeastAsViscousAsAnEddy) {
  expect_definition(of(0.5001, {}, 0.2));
  expect_definition(of(3, {}, 0.2));  // it is anyway
}

TEST(Regularised, KeepsMassAndMomentumToRounding) {
  std::mt19937_64 random(11);
  std::uniform_real_distribution<float> uniform(-0.01f, 0.01f);
  const Int3 size{64, 32, 32};
  Block<float> block({{0, 0, 0}, size});
  const CollisionRates<float> rates(of(0.5003));
  double before[4] = {}, after[4] = {};
  const auto for_populations = [&](auto&& slot_of, double(&sums)[4], auto&& touch) {
    for_cells({}, size, [&](Int3 x) {
      for (int i = 0; i < D3Q19::directions; ++i) {
        float& g = block.data()[slot_of(i) + block.cell(x)];
        touch(g);
        sums[0] += g;
        for (int d = 0; d < 3; ++d) sums[d + 1] += along(i, d) * g;
      }
    });
  };
  for_populations([&](int i) { return block.arriving(i, Parity::settled); }, before,
                  [&](float& g) { g = uniform(random); });
  std::vector<FastCell> fast;
  stream_collide(block, Parity::settled, rates, {0, size.y, 0, size.z}, {0, fast});
  for_populations([&](int i) { return block.leaving(i, Parity::crossed); }, after, [](float&) {});
  // a tenth of a population's rounding a cell: what a bias would leave, and chance does not
  const double bias = 0.1 * 0x1p-31 * double(size.x) * size.y * size.z;
  for (int k = 0; k < 4; ++k) EXPECT_NEAR(after[k], before[k], bias) << k;
}

template <class T>
class RowsOf : public ::testing::Test {
 protected:
  static constexpr Int3 cells{37, 3, 2};
  Fluid<T> fluid{
      Domain(cells, {}, std::nullopt, 1), {0.8, 3. / 16, Collision::trt, {1e-4, 0, 0}}, MPI_COMM_SELF};

  void set_at_random(int seed) {
    std::mt19937 random(seed);
    std::uniform_real_distribution<> any(-0.1, 0.1);
    for_cells({}, cells, [&](Int3 x) {
      for (int i = 0; i < D3Q19::directions; ++i) fluid.arriving(0, x, i) = T(any(random));
    });
  }
  Moments summed(Int3 x) const {
    Moments m;
    constexpr int pairs[6][2] = {{0, 0}, {1, 1}, {2, 2}, {0, 1}, {0, 2}, {1, 2}};
    for (int i = 0; i < D3Q19::directions; ++i) {
      const double g = fluid.arriving(0, x, i);
      m.density_deviation += g;
      for (int d = 0; d < 3; ++d) m.momentum[d] += g * D3Q19::c[i][d];
      for (int k = 0; k < 6; ++k) m.flux[k] += g * D3Q19::c[i][pairs[k][0]] * D3Q19::c[i][pairs[k][1]];
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

void expect_equal(const CellTotals& a, const CellTotals& b) {
  EXPECT_EQ(a.mass, b.mass);
  EXPECT_EQ(a.mass_square, b.mass_square);
  for (int d = 0; d < 3; ++d) EXPECT_EQ(a.momentum[d], b.momentum[d]);
  EXPECT_EQ(a.energy, b.energy);
  EXPECT_EQ(a.energy_rest, b.energy_rest);
  EXPECT_EQ(a.speed_squared, b.speed_squared);
  EXPECT_EQ(a.least_deviation, b.least_deviation);
  EXPECT_EQ(a.most_deviation, b.most_deviation);
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
      EXPECT_NEAR(double(t.mass_square) * CellTotals::square_quantum,
                  m.density_deviation * m.density_deviation, near + CellTotals::square_quantum);
      for (int d = 0; d < 3; ++d)
        EXPECT_NEAR(double(t.momentum[d]) * CellTotals::momentum_quantum, m.momentum[d], near + 4e-15);
      EXPECT_NEAR(double(t.energy) * CellTotals::energy_quantum +
                      double(t.energy_rest) * CellTotals::energy_rest_quantum,
                  square / 2, near);
      EXPECT_NEAR(t.speed_squared, square, near);
      EXPECT_NEAR(t.least_deviation, m.density_deviation, near);
      sum.mass += t.mass, sum.mass_square += t.mass_square;
      sum.energy += t.energy, sum.energy_rest += t.energy_rest;
      for (int d = 0; d < 3; ++d) sum.momentum[d] += t.momentum[d];
      sum.speed_squared = std::max(sum.speed_squared, t.speed_squared);
      sum.least_deviation = std::min(sum.least_deviation, t.least_deviation);
      sum.most_deviation = std::max(sum.most_deviation, t.most_deviation);
    }
    EXPECT_TRUE(found.sound);
    expect_equal(found, sum);
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
        for (int i = 0; i < D3Q19::directions; ++i) there.arriving(0, x, i) = this->fluid.arriving(0, x, i);
      });
      const std::pmr::vector<LocalRows> listed(rows, std::end(rows), memory_of(device));
      std::pmr::vector<CellTotals> found(listed.size(), memory_of(device));
      there.totals(0, listed, found.data());
      for (std::size_t k = 0; k < listed.size(); ++k) {
        const CellTotals expected = this->fluid.totals(0, listed[k]), &is = found[k];
        EXPECT_EQ(is.sound, expected.sound);
        if (!is.sound) continue;
        expect_equal(is, expected);
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
