// The model regularised against its definition: Hermite polynomials of the lattice, one population at a time.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <random>

#include "lbm/collision_model.hpp"
#include "lbm/stream_collide.hpp"

namespace silt::lbm {
namespace {

using Vector = std::array<double, 3>;
using Tensor = std::array<Vector, 3>;
using Populations = std::array<double, directions>;

constexpr double rounding = 1e-15;  // populations are of the size of 0.01

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

/// What g becomes: the equilibrium to third order with the stress off it relaxed, its trace at once, and what
/// follows from it in the third moments (Malaspinas, arXiv:1505.06900); what else is in those relaxed with
/// 1/tau_odd; Guo's force.
Populations regularised(const Populations& g, const CollisionSpec& spec, double added) {
  const Vector& force = spec.force;
  double rho = 0;
  Vector u{};
  Tensor off{};  // the stress off equilibrium, without its trace
  for (int i = 0; i < directions; ++i) {
    rho += g[i];
    for (int d = 0; d < 3; ++d) u[d] += along(i, d) * g[i];
  }
  for (int d = 0; d < 3; ++d) u[d] += force[d] / 2;
  for (int a = 0; a < 3; ++a)
    for (int b = 0; b < 3; ++b) {
      for (int i = 0; i < directions; ++i) off[a][b] += (along(i, a) * along(i, b) - delta(a, b) / 3) * g[i];
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
    for (int i = 0; i < directions; ++i) sum += keep_third * third_order(i, a, b, e) * g[i];
    const auto follows = [&](int d, int x, int y) {
      return u[d] * ((keep - keep_third) * off[x][y] - keep_third * delta(x, y) * trace);
    };
    return sum + (1 - keep_third) * u[a] * u[b] * u[e] + follows(a, b, e) + follows(b, a, e) +
           follows(e, a, b);
  };
  Populations even;  // what is of fourth order: the even halves less what rho and second moments say of them
  for (int i = 0; i < directions; ++i) {
    double sum = rho;
    for (int a = 0; a < 3; ++a)
      for (int b = 0; b < 3; ++b)
        sum += 4.5 * (along(i, a) * along(i, b) - delta(a, b) / 3) *
               (off[a][b] + delta(a, b) * trace + u[a] * u[b]);
    even[i] = (g[i] + g[opposite(i)]) / 2 - w(i) * sum;
  }
  const double keep_fourth = (1 - 1 / spec.relaxation_time) * spec.ghosts_as_trt();
  Populations after;
  for (int i = 0; i < directions; ++i) {
    double sum = rho + added;
    for (int a = 0; a < 3; ++a) {
      sum += 3 * along(i, a) * (u[a] + force[a] / 2);
      for (int b = 0; b < 3; ++b) sum += 4.5 * (along(i, a) * along(i, b) - delta(a, b) / 3) * second(a, b);
    }
    after[i] = w(i) * (sum + third_order_part(i, third)) + keep_fourth * even[i];
  }
  return after;
}

void expect_definition(const CollisionSpec& spec, double added = 0) {
  std::mt19937_64 random(7);
  std::uniform_real_distribution<double> uniform(-0.01, 0.01);
  const Int3 size{5, 3, 2};
  for (const Parity parity : {Parity::settled, Parity::crossed}) {
    Block<double> block({{0, 0, 0}, size});
    CollisionRates<double> rates(spec);
    rates.mass_correction = added;
    const Int3 x{3, 1, 1};
    Populations before;
    for (int i = 0; i < directions; ++i)
      block.data()[block.arriving(i, parity) + block.cell(x)] = before[i] = uniform(random);
    std::vector<FastCell> fast;
    stream_collide(block, parity, rates, {0, size.y, 0, size.z}, {0, fast});
    const Populations expected = regularised(before, spec, added);
    for (int i = 0; i < directions; ++i)
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
TEST(Regularised, TakesForceAndMassCorrection) {
  for (const double tau : {0.5001, 0.57, 0.9}) expect_definition(of(tau, {1e-3, -2e-3, 5e-4}), 1e-4);
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
  std::vector<FastCell> fast;
  stream_collide(block, Parity::settled, rates, {0, size.y, 0, size.z}, {0, fast});
  for_populations([&](int i) { return block.leaving(i, Parity::crossed); }, after, [](float&) {});
  // a tenth of a population's rounding a cell: what a bias would leave, and chance does not
  const double bias = 0.1 * 0x1p-31 * double(size.x) * size.y * size.z;
  for (int k = 0; k < 4; ++k) EXPECT_NEAR(after[k], before[k], bias) << k;
}

}  // namespace
}  // namespace silt::lbm
