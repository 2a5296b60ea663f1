// The model regularised against its definition: Hermite polynomials of the lattice, one population at a time.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <random>

#include "lbm/collision.hpp"
#include "lbm/stream_collide.hpp"

namespace silt::lbm {
namespace {

using Vector = std::array<double, 3>;
using Tensor = std::array<Vector, 3>;
using Populations = std::array<double, directions>;

constexpr double same = 1e-15;  // populations are of the size of 0.01

double delta(int a, int b) {
  return a == b;
}
double along(int i, int d) {
  return c[i][d];
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

/// Malaspinas' recursive regularisation (arXiv:1505.06900) with the equilibrium to third order, the trace of
/// the stress relaxed at once, and Guo's force: what g becomes.
Populations regularised(const Populations& g, double tau, const Vector& force, double added,
                        double constant = 0) {
  double rho = 0;
  Vector u{};
  Tensor off{};  // what the second moments are off equilibrium
  for (int i = 0; i < directions; ++i) {
    rho += g[i];
    for (int d = 0; d < 3; ++d) u[d] += along(i, d) * g[i];
  }
  for (int d = 0; d < 3; ++d) u[d] += force[d] / 2;
  for (int a = 0; a < 3; ++a)
    for (int b = 0; b < 3; ++b) {
      for (int i = 0; i < directions; ++i) off[a][b] += (along(i, a) * along(i, b) - delta(a, b) / 3) * g[i];
      off[a][b] -= u[a] * u[b] - (u[a] * force[b] + u[b] * force[a]) / 2;
    }
  const double trace = (off[0][0] + off[1][1] + off[2][2]) / 3;
  for (int d = 0; d < 3; ++d) off[d][d] -= trace;
  tau = std::max(tau, eddy_relaxation_time(off, constant));
  Tensor kept{};
  for (int a = 0; a < 3; ++a)
    for (int b = 0; b < 3; ++b) kept[a][b] = (1 - 1 / tau) * off[a][b];

  Populations after;
  for (int i = 0; i < directions; ++i) {
    double sum = rho + added;
    for (int a = 0; a < 3; ++a) {
      sum += 3 * along(i, a) * (u[a] + force[a] / 2);
      for (int b = 0; b < 3; ++b)
        sum += 4.5 * (along(i, a) * along(i, b) - delta(a, b) / 3) *
               (u[a] * u[b] + (u[a] * force[b] + u[b] * force[a]) / 2 + kept[a][b]);
    }
    sum += third_order_part(i, [&](int a, int b, int e) {
      const auto of = [&](int x, int y) { return kept[x][y] + (u[x] * force[y] + u[y] * force[x]) / 2; };
      return u[a] * u[b] * u[e] + u[a] * of(b, e) + u[b] * of(a, e) + u[e] * of(a, b);
    });
    after[i] = w(i) * sum;
  }
  return after;
}

struct Case {
  double tau;
  Vector force{};
  double added = 0, smagorinsky = 0;
};

void expect_definition(const Case& of) {
  std::mt19937_64 random(7);
  std::uniform_real_distribution<double> uniform(-0.01, 0.01);
  const Int3 size{5, 3, 2};
  for (const Parity parity : {Parity::settled, Parity::crossed}) {
    Block<double> block({{0, 0, 0}, size});
    CollisionRates<double> rates(CollisionSpec{of.tau, 0, Collision::regularised, of.force, of.smagorinsky});
    rates.mass_correction = of.added;
    rates.source |= of.added != 0;
    const Int3 x{3, 1, 1};
    Populations before;
    for (int i = 0; i < directions; ++i)
      block.data()[block.arriving(i, parity) + block.cell(x)] = before[i] = uniform(random);
    stream_collide(block, parity, rates, {0, size.y, 0, size.z});
    const Populations expected = regularised(before, of.tau, of.force, of.added, of.smagorinsky);
    for (int i = 0; i < directions; ++i)
      EXPECT_NEAR(block.data()[block.leaving(i, flipped(parity)) + block.cell(x)], expected[i], same) << i;
  }
}

TEST(Regularised, IsItsDefinition) {
  for (const double tau : {0.5001, 0.6, 1., 3.}) expect_definition({tau});
}
TEST(Regularised, TakesForceAndMassCorrection) {
  for (const double tau : {0.5001, 0.9}) expect_definition({tau, {1e-3, -2e-3, 5e-4}, 1e-4});
}

TEST(Regularised, IsAtLeastAsViscousAsAnEddy) {
  expect_definition({0.5001, {}, 0, 0.2});
  expect_definition({3, {}, 0, 0.2});  // it is anyway
}

TEST(Regularised, KeepsMassAndMomentumToRounding) {
  std::mt19937_64 random(11);
  std::uniform_real_distribution<float> uniform(-0.01f, 0.01f);
  const Int3 size{64, 32, 32};
  Block<float> block({{0, 0, 0}, size});
  const CollisionRates<float> rates(CollisionSpec{0.5003, 0, Collision::regularised, {}});
  double before[4] = {}, after[4] = {};
  const auto for_populations = [&](auto&& slot_of, double(&sums)[4], auto&& touch) {
    for (int z = 0; z < size.z; ++z)
      for (int y = 0; y < size.y; ++y)
        for (int x = 0; x < size.x; ++x)
          for (int i = 0; i < directions; ++i) {
            float& g = block.data()[slot_of(i) + block.cell(x, y, z)];
            touch(g);
            sums[0] += g;
            for (int d = 0; d < 3; ++d) sums[d + 1] += along(i, d) * g;
          }
  };
  for_populations([&](int i) { return block.arriving(i, Parity::settled); }, before,
                  [&](float& g) { g = uniform(random); });
  stream_collide(block, Parity::settled, rates, {0, size.y, 0, size.z});
  for_populations([&](int i) { return block.leaving(i, Parity::crossed); }, after, [](float&) {});
  // a tenth of a population's rounding a cell: what a bias would leave, and chance does not
  const double bias = 0.1 * 0x1p-31 * double(size.x) * size.y * size.z;
  for (int k = 0; k < 4; ++k) EXPECT_NEAR(after[k], before[k], bias) << k;
}

}  // namespace
}  // namespace silt::lbm
