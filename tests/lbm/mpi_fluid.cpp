// The fluid alone, on any number of ranks: theory for the walls, and the same bits for every layout.
#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <functional>

#include "lbm/blocks/equal_cut.hpp"
#include "lbm/fluid.hpp"
#include "tests/lbm/sides.hpp"
#include "tests/odd_cut.hpp"
#include "tests/world.hpp"

namespace silt::lbm {
namespace {

using testing::no_slip;
using testing::periodic;
using testing::slip;
using tests::largest_of_ranks;
using tests::ranks;

SideCondition side(SideKind kind, std::array<double, 3> v = {}, double rho = 0) {
  return {kind, v, rho};
}
std::array<SideCondition, 6> sides(SideCondition x, SideCondition y, SideCondition zl, SideCondition zh) {
  return {x, x, y, y, zl, zh};
}

template <class T>
void step(Fluid<T>& fluid) {
  fluid.stream_collide();
  fluid.exchange();
}

/// Calls f(block, local cell, global cell) for every cell of this rank.
template <class T, class F>
void for_cells(Fluid<T>& fluid, F&& f) {
  for (int b = 0; b < int(fluid.blocks().size()); ++b) {
    const CellBox& box = fluid.blocks()[b].box();
    for (int z = 0; z < box.size.z; ++z)
      for (int y = 0; y < box.size.y; ++y)
        for (int x = 0; x < box.size.x; ++x) f(b, Int3{x, y, z}, box.lower + Int3{x, y, z});
  }
}

/// A hash without order: every population's bits are mixed with where it is.
template <class T>
std::uint64_t fingerprint(Fluid<T>& fluid) {
  std::uint64_t sum = 0, all = 0;
  for_cells(fluid, [&](int b, Int3 x, Int3 g) {
    for (int i = 0; i < D3Q19::directions; ++i) {
      std::uint64_t h = std::bit_cast<std::uint64_t>(double(fluid.arriving(b, x, i)));
      h ^= std::uint64_t(((g.z * 1009 + g.y) * 1009 + g.x) * 19 + i) * 0x9E3779B97F4A7C15u;
      h ^= h >> 31, h *= 0xBF58476D1CE4E5B9u, h ^= h >> 29;
      sum += h;
    }
  });
  MPI_Allreduce(&sum, &all, 1, MPI_UINT64_T, MPI_SUM, fluid.comm());
  return all;
}

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
  for_cells(fluid, [&](int b, Int3 x, Int3 at) {
    fluid.set_equilibrium(b, x, 0, {exact(at.z) - g / 2, 0, 0});
  });
  for (int t = 0; t < int(40 * h * h / nu / 10); ++t) step(fluid);
  double error = 0;
  for_cells(fluid, [&](int b, Int3 x, Int3 at) {
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
      Domain({3, 8, h}, sides(periodic, periodic, no_slip, side(SideKind::bounce, {u0, 0.5 * u0, 0})),
             Int3{3, 1, 4}, ranks()),
      {0.9, 3. / 16, Collision::trt, {}}, MPI_COMM_WORLD);
  for (int t = 0; t < 8000; ++t) step(fluid);
  double error = 0;
  for_cells(fluid, [&](int b, Int3 x, Int3 at) {
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
    for_cells(fluid, [&](int b, Int3 x, Int3 at) {
      const double z = at.z + 0.5, exact = g / (2 * nu) * z * (2 * h - z);
      error = std::max(error, std::fabs(fluid.velocity(fluid.moments(b, x))[axis] / exact - 1));
    });
    EXPECT_LT(largest_of_ranks(error), 1e-9) << "axis " << axis;
  }
}

// Plug flow in at x low, out at x high between free-slip planes: a uniform stream must stay uniform.
TEST(Fluid, InletAndOutletCarryAUniformStream) {
  const double u0 = 0.01;
  const auto inlet = side(SideKind::bounce, {u0, 0, 0}), outlet = side(SideKind::pressure);
  const std::array<SideCondition, 6> s{inlet, outlet, periodic, periodic, slip, slip};
  Fluid<double> fluid(Domain({16, 4, 8}, s, Int3{4, 2, 8}, ranks()), {0.8, 3. / 16, Collision::trt, {}},
                      MPI_COMM_WORLD);
  for (int t = 0; t < 6000; ++t) step(fluid);
  double error = 0;
  for_cells(fluid, [&](int b, Int3 x, Int3) {
    const auto u = fluid.velocity(fluid.moments(b, x));
    error = std::max({error, std::fabs(u[0] - u0), std::fabs(u[1]), std::fabs(u[2])});
  });
  EXPECT_LT(largest_of_ranks(error) / u0, 0.01);
}

// Square duct: the series solution's u_max mu / (G a^2) = 0.2946854160 and mean 0.1405770150 (a: full edge...
// half edge).
TEST(Fluid, SquareDuctFlowRate) {
  const int n = 16;
  const double g = 1e-6, nu = 0.5 / 3, a = n / 2.0;
  const std::array<SideCondition, 6> s{periodic, periodic, no_slip, no_slip, no_slip, no_slip};
  Fluid<double> fluid(Domain({4, n, n}, s, Int3{4, 8, 4}, ranks()), {1.0, 3. / 16, Collision::trt, {g, 0, 0}},
                      MPI_COMM_WORLD);
  for (int t = 0; t < 5000; ++t) step(fluid);
  double sum = 0;
  for_cells(fluid, [&](int b, Int3 x, Int3) { sum += fluid.velocity(fluid.moments(b, x))[0]; });
  EXPECT_NEAR(tests::sum_over_ranks(sum) / (4 * n * n) * nu / (g * a * a) / 0.1405770150 * 1.0, 1.0, 0.005);
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
  for_cells(fluid, [&](int b, Int3 x, Int3 g) {
    const double p = -0.25 * u0 * u0 * (std::cos(2 * k * (g.x + 0.5)) + std::cos(2 * k * (g.z + 0.5)));
    const auto u = exact(g, 0);
    fluid.set_equilibrium(b, x, 3 * p, u);
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
  for_cells(fluid, [&](int b, Int3 x, Int3 g) {
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

/// The sides across x of a stirred box: what rows do by themselves, and what they leave to the lists.
struct AcrossRows {
  const char* name;
  SideCondition low, high;
};
const AcrossRows across_rows[] = {{"periodic", periodic, periodic},
                                  {"free slip and no slip", slip, no_slip},
                                  {"moving wall and outlet", side(SideKind::bounce, {0.001, 0.02, 0.01}),
                                   side(SideKind::pressure, {}, 1e-3)}};

/// Cuts cells for so many ranks.
using Cutting = std::function<CutTree(Int3 cells, int ranks)>;
Cutting blocks_of(Int3 size) {
  return [=](Int3 cells, int) { return grid_cut(cells, size); };
}
Cutting oddly(int blocks_a_rank, int edge) {
  return [=](Int3 cells, int ranks) { return tests::odd_cut(cells, blocks_a_rank * ranks, edge, ranks); };
}

/// A stirred box with walls, on the ranks of a communicator.
template <class T>
std::uint64_t stirred(const AcrossRows& across, Int3 cells, const Cutting& cut, int steps,
                      MPI_Comm comm = MPI_COMM_WORLD, Device device = Device::cpu,
                      Collision model = Collision::trt, double tau = 0.6, double force = 1e-5) {
  int size = 1;
  MPI_Comm_size(comm, &size);
  const auto moving = side(SideKind::bounce, {0.03, 0.01, 0});
  const std::array<SideCondition, 6> s{across.low, across.high, periodic, periodic, moving, no_slip};
  Fluid<T> fluid(Domain(cut(cells, size), s, size), {tau, 3. / 16, model, {force, 2 * force, 0}, 0.1}, comm,
                 device);
  for_cells(fluid, [&](int b, Int3 x, Int3 g) {
    fluid.set_equilibrium(b, x, 1e-3 * std::sin(g.x + 2.0 * g.y),
                          {0.01 * std::sin(3.0 * g.z), 0.02 * std::cos(2.0 * g.x), 0});
  });
  for (int t = 0; t < steps; ++t) step(fluid);
  return fingerprint(fluid);
}

TEST(Fluid, SameBitsOnEveryDevice) {
  struct Flow {
    Collision model;
    double tau, force;
  };
  const Int3 n{21, 13, 16};
  std::vector<Device> others = {Device::host};
  if (unusable(Device::gpu).empty()) others.push_back(Device::gpu);
  for (const Device device : others)
    for (const AcrossRows& across : across_rows)
      for (const Flow& flow :
           {Flow{Collision::trt, 0.6, 0}, Flow{Collision::bgk, 0.8, 1e-5},
            Flow{Collision::regularised, 0.51, 0}, Flow{Collision::regularised, 0.6, 1e-5}})
        for (const int steps : {20, 21}) {
          SCOPED_TRACE(across.name);
          const auto on = [&]<class T>(T, const Cutting& cut, Device where) {
            return stirred<T>(across, n, cut, steps, MPI_COMM_WORLD, where, flow.model, flow.tau, flow.force);
          };
          EXPECT_EQ(on(float{}, equal_cut, Device::cpu), on(float{}, equal_cut, device));
          EXPECT_EQ(on(double{}, equal_cut, Device::cpu), on(double{}, blocks_of({5, 7, 4}), device));
        }
}

TEST(Fluid, ADeviceSeesTheSameFastCells) {
  const auto fast = [](Device device) {
    Fluid<float> fluid(Domain({9, 5, 20}, {}, std::nullopt, ranks()), {0.6}, MPI_COMM_WORLD, device);
    for_cells(fluid, [&](int b, Int3 x, Int3 g) {
      const double speed = g.x == 4 && g.z % 3 == 0 ? 0.7 : g == Int3{7, 2, 16} ? NAN : 0;
      fluid.set_equilibrium(b, x, 0, {speed, 0, 0});
    });
    fluid.stream_collide();
    std::vector<std::tuple<int, int, int, int, std::uint64_t>> found;
    for (const auto& [block, cell, speed] : fluid.fast_cells())
      found.emplace_back(block, cell.x, cell.y, cell.z, std::bit_cast<std::uint64_t>(speed));
    std::sort(found.begin(), found.end());  // a device tells of the shell and the rest together
    fluid.exchange();                       // messages under way would arrive where the fluid no longer is
    return found;
  };
  EXPECT_EQ(fast(Device::cpu), fast(Device::host));
  EXPECT_GT(tests::largest_of_ranks(double(fast(Device::host).size())), 0);
}

TEST(Fluid, SameBitsForEveryRankCountAndLayout) {
  const Int3 n{21, 13, 16};
  for (const AcrossRows& across : across_rows)
    for (int steps : {40, 41}) {
      SCOPED_TRACE(across.name);
      const auto alone = stirred<float>(across, n, blocks_of(n), steps, MPI_COMM_SELF);
      EXPECT_EQ(alone, stirred<float>(across, n, equal_cut, steps));
      EXPECT_EQ(alone, stirred<float>(across, n, blocks_of({5, 7, 4}), steps));
      EXPECT_EQ(alone, stirred<float>(across, n, blocks_of({21, 4, 3}), steps));
      EXPECT_EQ(alone, stirred<float>(across, n, blocks_of({2, 3, 2}), steps, MPI_COMM_SELF));
      EXPECT_EQ(stirred<double>(across, n, blocks_of(n), steps, MPI_COMM_SELF),
                stirred<double>(across, n, blocks_of({8, 5, 4}), steps));
      EXPECT_NE(alone, stirred<float>(across, n, equal_cut, steps + 2));
    }
}

// A block may share any part of a face or an edge with another.
TEST(Fluid, SameBitsForOddCuts) {
  const Int3 n{21, 13, 16};
  for (const AcrossRows& across : across_rows)
    for (int steps : {40, 41}) {
      SCOPED_TRACE(across.name);
      const auto alone = stirred<float>(across, n, blocks_of(n), steps, MPI_COMM_SELF);
      EXPECT_EQ(alone, stirred<float>(across, n, oddly(1, 2), steps));
      EXPECT_EQ(alone, stirred<float>(across, n, oddly(5, 1), steps));
      EXPECT_EQ(alone, stirred<float>(across, n, oddly(37, 1), steps, MPI_COMM_SELF));
    }
}

// Rows of every length next to the widths of vectors: cells beyond a row's end are left alone.
TEST(Fluid, SameBitsForRowsOfAnyLength) {
  for (const AcrossRows& across : across_rows)
    for (int x : {2, 7, 8, 14, 15, 16, 17, 30, 33}) {
      SCOPED_TRACE(std::string(across.name) + ", rows of " + std::to_string(x));
      const Int3 n{x, 5, 16};
      EXPECT_EQ(stirred<float>(across, n, blocks_of({x, 5, 2}), 7),
                stirred<float>(across, n, blocks_of({(x + 1) / 2, 3, 2}), 7));
    }
}

// Rows at faces across y and z collide first, and what they send other ranks leaves at once; at a face across
// x every row has a part.
TEST(Fluid, MessagesSetOutBeforeThePassIsDone) {
  const std::array<SideCondition, 6> periodic_sides{};
  const CollisionSpec collision{0.9, 3. / 16, Collision::trt, {}};
  for (int axis = 0; axis < 3; ++axis) {
    Int3 n{8, 8, 8}, blocks{8, 8, 8};
    n[axis] = 8 * ranks();
    const Fluid<float> fluid(Domain(n, periodic_sides, blocks, ranks()), collision, MPI_COMM_WORLD);
    const std::size_t all = fluid.halo().message_bytes();
    EXPECT_EQ(all > 0, ranks() > 1);
    EXPECT_EQ(fluid.halo().message_bytes(true), axis == 0 ? 0 : all) << "cut across axis " << axis;
  }
}

// Walls at the ends of rows: u_y(x) and u_z(x) are linear.
TEST(Fluid, CouetteAcrossRowsIsLinear) {
  const double u0 = 0.02;
  const int h = 11;
  const auto moving = side(SideKind::bounce, {0, u0, 0.5 * u0});
  const std::array<SideCondition, 6> s{no_slip, moving, periodic, periodic, periodic, periodic};
  Fluid<double> fluid(Domain({h, 3, 8}, s, Int3{h, 3, 1}, ranks()), {0.9, 3. / 16, Collision::trt, {}},
                      MPI_COMM_WORLD);
  for (int t = 0; t < 10000; ++t) step(fluid);
  double error = 0;
  for_cells(fluid, [&](int b, Int3 x, Int3 at) {
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
  for_cells(fluid, [&](int b, Int3 x, Int3 at) {
    for (int i = 1; i < D3Q19::directions; ++i)
      wrong = std::max(wrong,
                       std::fabs(fluid.arriving(b, x, i) - 6 * D3Q19::w(i) * expected(at - D3Q19::c[i], i)));
  });
  return largest_of_ranks(wrong);
}

/// One of the sides moves, the others rest.
std::array<SideCondition, 6> one_moves(int axis, bool upper, int along, double speed) {
  std::array<SideCondition, 6> s;
  s.fill(no_slip);
  s[2 * axis + upper].velocity[along] = speed;
  return s;
}

// c u along the links that met the face of the lid, nothing along those that met an edge.
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
        EXPECT_LT(wrong_at_first(one_moves(axis, upper, along, speed), expected), 1e-15)
            << axis << upper << along;
      }
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
}  // namespace silt::lbm
