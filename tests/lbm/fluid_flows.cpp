// The fluid alone against theory: walls, sides and a vortex, in several blocks of one rank.
#include <gtest/gtest.h>

#include <cmath>

#include "tests/lbm/fluid_cells.hpp"
#include "tests/world.hpp"

namespace silt::lbm::testing {
namespace {

using tests::largest_of_ranks;
using tests::ranks;

// u(z) = g/(2 nu) z (H - z) + slip, z = k + 1/2; slip = g (16 Lambda - 3)/(24 nu) (halfway walls, exact
// solution).
double poiseuille_error(double tau, double magic, Collision model = Collision::trt) {
  const double g = 1e-6, nu = (tau - 0.5) / 3,
               lambda = CollisionSpec{tau, magic, model, {}}.magic_in_effect();
  const int h = 8;
  Fluid<double> fluid(Domain({4, 8, h}, sides(periodic, periodic, no_slip, no_slip), Int3{4, 1, 4}, ranks()),
                      {tau, magic, model, {g, 0, 0}}, MPI_COMM_WORLD);
  const auto exact = [&](int k) {
    const double z = k + 0.5;
    return g / (2 * nu) * z * (h - z) + g * (16 * lambda - 3) / (24 * nu);
  };
  for_all_cells(fluid, [&](int b, Int3 x, Int3 at) {
    set_equilibrium(fluid, b, x, 0, {exact(at.z) - g / 2, 0, 0});
  });
  for (int t = 0; t < int(40 * h * h / nu / 10); ++t) step(fluid);
  double error = 0;
  for_all_cells(fluid, [&](int b, Int3 x, Int3 at) {
    const double u = fluid.velocity(fluid.moments(b, x))[0];
    error = std::max(error, std::fabs(u - exact(at.z)) / exact(h / 2));
  });
  return largest_of_ranks(error);
}

TEST(Fluid, PoiseuilleExactToRoundOff) {
  EXPECT_LT(poiseuille_error(0.8, 3. / 16), 1e-10);
  EXPECT_LT(poiseuille_error(1.4, 3. / 16), 1e-10);
}

TEST(Fluid, WallSlipOfOtherSchemesIsTheTheoretical) {
  EXPECT_LT(poiseuille_error(0.8, 1. / 4), 1e-10);
  EXPECT_LT(poiseuille_error(0.8, 0, Collision::bgk), 1e-10);
  EXPECT_LT(poiseuille_error(0.8, 1. / 4, Collision::regularised), 1e-10);
}

TEST(Fluid, CouetteIsLinear) {
  const double u0 = 0.02;
  const int h = 8;
  Fluid<double> fluid(
      Domain({3, 8, h},
             sides(periodic, periodic, no_slip, side_condition(SideKind::bounce, {u0, 0.5 * u0, 0})),
             Int3{3, 1, 4}, ranks()),
      {0.9, 3. / 16, Collision::trt, {}}, MPI_COMM_WORLD);
  for (int t = 0; t < 8000; ++t) step(fluid);
  double error = 0;
  for_all_cells(fluid, [&](int b, Int3 x, Int3 at) {
    const auto u = fluid.velocity(fluid.moments(b, x));
    error = std::max(
        {error, std::fabs(u[0] - u0 * (at.z + 0.5) / h), std::fabs(u[1] - 0.5 * u0 * (at.z + 0.5) / h)});
  });
  EXPECT_LT(largest_of_ranks(error), 1e-12);
}

// Half of a Poiseuille channel: free slip in the middle (slip at z high and, with the force along y,
// tangentially across block borders).
TEST(Fluid, FreeSlipIsASymmetryPlane) {
  const int h = 8;
  const double g = 1e-6, nu = 0.1;
  for (int axis = 0; axis < 2; ++axis) {
    Fluid<double> fluid(Domain({8, 8, h}, sides(periodic, periodic, no_slip, slip), Int3{4, 2, 4}, ranks()),
                        {0.5 + 3 * nu, 3. / 16, Collision::trt, {axis == 0 ? g : 0, axis == 1 ? g : 0, 0}},
                        MPI_COMM_WORLD);
    for (int t = 0; t < 12000; ++t) step(fluid);
    double error = 0;
    for_all_cells(fluid, [&](int b, Int3 x, Int3 at) {
      const double z = at.z + 0.5, exact = g / (2 * nu) * z * (2 * h - z);
      error = std::max(error, std::fabs(fluid.velocity(fluid.moments(b, x))[axis] / exact - 1));
    });
    EXPECT_LT(largest_of_ranks(error), 1e-9) << "axis " << axis;
  }
}

// Plug flow in at x low, out at x high between free-slip planes: a uniform stream must stay uniform.
TEST(Fluid, InletAndOutletCarryAUniformStream) {
  const double u0 = 0.01;
  const auto inlet = side_condition(SideKind::bounce, {u0, 0, 0}),
             outlet = side_condition(SideKind::pressure);
  const std::array<SideCondition, 6> s{inlet, outlet, periodic, periodic, slip, slip};
  Fluid<double> fluid(Domain({16, 4, 8}, s, Int3{4, 2, 8}, ranks()), {0.8, 3. / 16, Collision::trt, {}},
                      MPI_COMM_WORLD);
  for (int t = 0; t < 6000; ++t) step(fluid);
  double error = 0;
  for_all_cells(fluid, [&](int b, Int3 x, Int3) {
    const auto u = fluid.velocity(fluid.moments(b, x));
    error = std::max({error, std::fabs(u[0] - u0), std::fabs(u[1]), std::fabs(u[2])});
  });
  EXPECT_LT(largest_of_ranks(error) / u0, 0.01);
}

double taylor_green_error(int n) {
  // u = -U cos kx sin kz, w = U sin kx cos kz, decaying as exp(-2 nu k^2 t); U shrinks with n at fixed Re
  // (diffusive scaling).
  const double u0 = 0.02 * 16 / n, nu = 0.1, k = 2 * M_PI / n;
  Fluid<double> fluid(
      Domain({n, 2, n}, sides(periodic, periodic, periodic, periodic), Int3{n, 2, n / 8}, ranks()),
      {0.5 + 3 * nu, 1. / 4, Collision::trt, {}}, MPI_COMM_WORLD);
  const auto exact = [&](Int3 g, double t) {
    const double d = u0 * std::exp(-2 * nu * k * k * t), x = k * (g.x + 0.5), z = k * (g.z + 0.5);
    return std::array<double, 3>{-d * std::cos(x) * std::sin(z), 0, d * std::sin(x) * std::cos(z)};
  };
  for_all_cells(fluid, [&](int b, Int3 x, Int3 g) {
    const double p = -0.25 * u0 * u0 * (std::cos(2 * k * (g.x + 0.5)) + std::cos(2 * k * (g.z + 0.5)));
    const auto u = exact(g, 0);
    set_equilibrium(fluid, b, x, 3 * p, u);
    // the non-equilibrium part, -tau w_i 3 (c c : grad u): else the start is only first order
    const double xk = k * (g.x + 0.5), zk = k * (g.z + 0.5), tau = 0.5 + 3 * nu;
    const double dxu = u0 * k * std::sin(xk) * std::sin(zk), dzw = -u0 * k * std::sin(xk) * std::sin(zk);
    for (int i = 0; i < D3Q19::directions; ++i)
      fluid.arriving(b, x, i) -=
          tau * D3Q19::w(i) * 3 * (D3Q19::c[i].x * D3Q19::c[i].x * dxu + D3Q19::c[i].z * D3Q19::c[i].z * dzw);
  });
  const int steps = int(0.5 / (nu * k * k)) / 2 * 2;
  for (int t = 0; t < steps; ++t) step(fluid);
  double e[2] = {0, 0}, sum[2];
  for_all_cells(fluid, [&](int b, Int3 x, Int3 g) {
    const auto u = fluid.velocity(fluid.moments(b, x)), v = exact(g, steps);
    for (int d = 0; d < 3; ++d) e[0] += (u[d] - v[d]) * (u[d] - v[d]), e[1] += v[d] * v[d];
  });
  MPI_Allreduce(e, sum, 2, MPI_DOUBLE, MPI_SUM, MPI_COMM_WORLD);
  return std::sqrt(sum[0] / sum[1]);
}

TEST(Fluid, TaylorGreenIsSecondOrder) {
  const double coarse = taylor_green_error(32), fine = taylor_green_error(64),
               slope = std::log2(coarse / fine);
  RecordProperty("slope", std::to_string(slope));
  EXPECT_GE(slope, 1.9) << coarse << " " << fine;
  EXPECT_LT(fine, 0.005);
}

// Walls at the ends of rows: u_y(x) and u_z(x) are linear.
TEST(Fluid, CouetteAcrossRowsIsLinear) {
  const double u0 = 0.02;
  const int h = 11;
  const auto moving = side_condition(SideKind::bounce, {0, u0, 0.5 * u0});
  const std::array<SideCondition, 6> s{no_slip, moving, periodic, periodic, periodic, periodic};
  Fluid<double> fluid(Domain({h, 3, 8}, s, Int3{h, 3, 1}, ranks()), {0.9, 3. / 16, Collision::trt, {}},
                      MPI_COMM_WORLD);
  for (int t = 0; t < 10000; ++t) step(fluid);
  double error = 0;
  for_all_cells(fluid, [&](int b, Int3 x, Int3 at) {
    const auto u = fluid.velocity(fluid.moments(b, x));
    const double share = (at.x + 0.5) / h;
    error = std::max({error, std::fabs(u[1] - u0 * share), std::fabs(u[2] - 0.5 * u0 * share)});
  });
  EXPECT_LT(largest_of_ranks(error), 1e-12);
}

constexpr Int3 closed{6, 7, 5};  // cells of a box between walls

/// The largest deviation, after one step from rest in a closed box with such sides, of what arrives along i
/// from the cell `from` (outside: from a wall) from 6 w_i expected(from, i).
template <class Expected>
double wrong_at_first(const std::array<SideCondition, 6>& s, Expected&& expected) {
  Fluid<double> fluid(Domain(closed, s, std::nullopt, ranks()), {0.9, 3. / 16, Collision::trt, {}},
                      MPI_COMM_WORLD);
  step(fluid);
  double wrong = 0;
  for_all_cells(fluid, [&](int b, Int3 x, Int3 at) {
    for (int i = 1; i < D3Q19::directions; ++i)
      wrong = std::max(wrong,
                       std::fabs(fluid.arriving(b, x, i) - 6 * D3Q19::w(i) * expected(at - D3Q19::c[i], i)));
  });
  return largest_of_ranks(wrong);
}

/// One of the sides moves, the others rest, or are mirrors.
std::array<SideCondition, 6> one_moves(int axis, bool upper, int along, double speed,
                                       SideKind others = SideKind::bounce) {
  std::array<SideCondition, 6> s;
  s.fill({others});
  s[2 * axis + upper] = no_slip;
  s[2 * axis + upper].velocity[along] = speed;
  return s;
}

// c u along the links that met the face of the lid, nothing along those that met an edge, with another side
// or with the mirror image of the lid, which comes the other way.
TEST(Fluid, ASideThatSlidesLeavesItsEdgesAtRest) {
  constexpr double speed = 0.01;
  for (int axis = 0; axis < 3; ++axis)
    for (const int along : {(axis + 1) % 3, (axis + 2) % 3})
      for (const bool upper : {false, true}) {
        const auto expected = [&](Int3 from, int i) {
          int met = 0;
          for (int d = 0; d < 3; ++d) met += from[d] < 0 || from[d] >= closed[d];
          const bool off_lid = upper ? from[axis] >= closed[axis] : from[axis] < 0;
          return off_lid && met == 1 ? D3Q19::c[i][along] * speed : 0;
        };
        for (const SideKind others : {SideKind::bounce, SideKind::free_slip})
          EXPECT_LT(wrong_at_first(one_moves(axis, upper, along, speed, others), expected), 1e-15)
              << axis << upper << along;
      }
}

// Half of what left returns with the pressure of the outlet, where two meet with the lesser one, whatever
// axes they lie across.
TEST(Fluid, AtTheEdgeOfTwoOutletsTheLesserPressureHolds) {
  constexpr double pressure[3] = {0.03, 0.01, 0.02};
  std::array<SideCondition, 6> s;
  s.fill(no_slip);
  for (int d = 0; d < 3; ++d) s[2 * d + 1].kind = SideKind::pressure, s[2 * d + 1].value = pressure[d];
  const auto expected = [&](Int3 from, int) {
    double least = 1;
    for (int d = 0; d < 3; ++d) {
      if (from[d] < 0) return 0.;
      if (from[d] >= closed[d]) least = std::min(least, pressure[d]);
    }
    return least < 1 ? least / 3 : 0;
  };
  EXPECT_LT(wrong_at_first(s, expected), 1e-15);
}

// Fluid flows in through a side up to its edges.
TEST(Fluid, AnInletReachesItsEdges) {
  constexpr double speed = 0.01;
  for (int axis = 0; axis < 3; ++axis) {
    const auto expected = [&](Int3 from, int) { return from[axis] < 0 ? speed : 0; };
    EXPECT_LT(wrong_at_first(one_moves(axis, false, axis, speed), expected), 1e-15) << axis;
  }
}

}  // namespace
}  // namespace silt::lbm::testing
