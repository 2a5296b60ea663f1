// Cells of several levels, on any number of ranks: what passes a border unchanged, what is conserved, and the
// same bits for every layout.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "tests/lbm/levelled_cut.hpp"
#include "tests/lbm/levelled_flow.hpp"
#include "tests/lbm/sides.hpp"
#include "tests/world.hpp"

namespace silt::lbm {
namespace {

using testing::LevelledCut;
using testing::LevelledFlow;
using testing::Vector;
using tests::ranks;

using Sides = std::array<SideCondition, 6>;

/// Made of tiles of 8 cells there is an L of finest cells, so that edges and corners are convex and concave,
/// with a margin of the next level, in `levels` coarser ones.
int bent(Int3 x, int levels) {
  const Int3 t{x.x / 8, x.y / 8, x.z / 8};
  const auto in = [&](int low, int high) {
    return t.x >= low && t.x < high && t.y >= low && t.y < high && t.z >= low && t.z < high;
  };
  if (in(2, 4) && !(t.x == 2 && t.y == 2) && !(t.y == 3 && t.z == 3)) return 0;
  return levels == 1 || in(0, 6) ? 1 : 2;
}

Sides all(const SideCondition& side) {
  Sides sides;
  sides.fill(side);
  return sides;
}

template <class T>
void stir(LevelledFlow<T>& flow, Int3 n) {
  const double k = 2 * std::numbers::pi;
  flow.set([&](const Vector& x, double& rho, Vector& u, std::array<Vector, 3>&) {
    rho = 0.01 * std::sin(k * (x[0] / n.x + 2 * x[1] / n.y));
    u = {0.03 * std::sin(k * (x[1] / n.y + x[2] / n.z)), 0.02 * std::cos(2 * k * x[0] / n.x),
         0.03 * std::sin(k * (x[0] / n.x - x[1] / n.y))};
  });
}

TEST(Levels, MassAndMomentumAreConserved) {
  for (const Collision model : {Collision::trt, Collision::regularised})
    for (const int coarser : {1, 2}) {
      const Int3 n{64, 64, 64};
      const LevelledCut cut(
          n, 8, [&](Int3 x) { return bent(x, coarser); }, ranks(), 24);
      LevelledFlow<double> flow(cut.tree(), {}, {0.8, 1. / 6, model}, coarser);
      stir(flow, n);
      const auto before = flow.sum();
      flow.step(40);
      const auto after = flow.sum();
      EXPECT_NEAR(after.mass, before.mass, 1e-10);
      for (int d = 0; d < 3; ++d) EXPECT_NEAR(after.momentum[d], before.momentum[d], 1e-10);
    }
}

/// Between walls on which fluid may slip along two axes, and not along the third.
TEST(Levels, WallsThroughABorderKeepTheMass) {
  Sides walls = all({SideKind::bounce, {}, 0});
  walls[2] = walls[3] = {SideKind::free_slip, {}, 0};
  walls[5].velocity = {0.03, 0.01, 0};
  const Int3 n{32, 32, 32};
  const LevelledCut cut(
      n, 8, [&](Int3 x) { return (x.x / 8 + x.y / 8 + x.z / 8) % 2; }, ranks());
  LevelledFlow<double> flow(cut.tree(), walls, {0.8, 1. / 6, Collision::trt, {1e-4, 2e-4, -1e-4}}, 1);
  stir(flow, n);
  const double before = flow.sum().mass;
  flow.step(40);
  EXPECT_NEAR(flow.sum().mass, before, 1e-11);
}

/// Fluid that moves as a whole, through a lattice whose cells change size, stays as it is; so does fluid at
/// rest in a linear pressure that a force holds.
TEST(Levels, UniformFlowAndLinearPressurePassABorder) {
  const Int3 n{64, 64, 64};
  const LevelledCut cut(
      n, 8, [&](Int3 x) { return bent(x, 2); }, ranks());
  const Vector u = {0.04, -0.03, 0.05};
  LevelledFlow<double> moving(cut.tree(), {}, {0.7}, 2);
  moving.set([&](const Vector&, double& rho, Vector& v, auto&) { rho = 0.01, v = u; });
  moving.step(24);
  double off = 0;
  moving.for_all([&](Fluid<double>& fluid, int b, Int3 x, const Vector&, int) {
    const Moments m = fluid.moments(b, x);
    off = std::max(off, std::abs(m.density_deviation - 0.01));
    for (int d = 0; d < 3; ++d) off = std::max(off, std::abs(m.momentum[d] - u[d]));
  });
  EXPECT_LT(tests::largest_of_ranks(off), 1e-14);

  const Vector f = {2e-6, -1e-6, 3e-6};
  LevelledFlow<double> still(cut.tree(), all({SideKind::bounce, {}, 0}), {0.7, 1. / 6, Collision::trt, f}, 2);
  const auto pressed = [&](const Vector& at) { return 3 * (f[0] * at[0] + f[1] * at[1] + f[2] * at[2]); };
  still.set([&](const Vector& at, double& rho, Vector&, auto&) { rho = pressed(at); });
  still.step(24);
  off = 0;
  still.for_all([&](Fluid<double>& fluid, int b, Int3 x, const Vector& at, int) {
    const Moments m = fluid.moments(b, x);
    off = std::max(off, std::abs(m.density_deviation - pressed(at)));
    for (const double v : fluid.velocity(m)) off = std::max(off, std::abs(v));
  });
  EXPECT_LT(tests::largest_of_ranks(off), 1e-14);
}

template <class T>
std::uint64_t stirred(const CutTree& tree, const Sides& sides, MPI_Comm comm, Device device = Device::cpu) {
  LevelledFlow<T> flow(tree, sides, {0.6, 1. / 6, Collision::trt, {1e-5, 0, 2e-5}}, 2, comm, device);
  flow.for_all([](Fluid<T>& fluid, int b, Int3 x, const Vector& at, int) {
    const double rho = 0.01 * std::sin(at[0] + 2 * at[1]), u = 0.05 * std::cos(at[2] - at[0]);
    fluid.set_equilibrium(b, x, rho, {u, -u, u / 2});
  });
  flow.step(12);
  return flow.fingerprint();
}

/// Cells that are refined and coarsened, by two levels at once too, while fluid passes; the blocks change as
/// well.
template <class T>
std::unique_ptr<LevelledFlow<T>> regridded(MPI_Comm comm, int longest) {
  const Int3 n{64, 64, 64};
  const int ranks = parallel::ranks_of(comm);
  const auto tree = [&](int shift) {
    return LevelledCut(
               n, 8,
               [&](Int3 x) {
                 return bent({(x.x + shift) % 64, (x.y + 2 * shift) % 64, x.z}, 2);
               },
               ranks, longest, [&](Int3 x) { return (x.x / 8 + x.z / 16) % ranks; })
        .tree();
  };
  std::unique_ptr<LevelledFlow<T>> flow;
  for (int shift = 0; shift < 64; shift += 16) {
    auto next = std::make_unique<LevelledFlow<T>>(tree(shift), Sides{}, CollisionSpec{0.7, 1. / 6}, 2, comm);
    if (flow)
      move_populations(flow->levels, next->levels);
    else
      stir(*next, n);
    flow = std::move(next);
    flow->step(4);
  }
  return flow;
}

TEST(Levels, CellsThatChangeTheirLevelKeepMassAndMomentum) {
  LevelledFlow<double> first(LevelledCut(
                                 {64, 64, 64}, 8, [](Int3 x) { return bent(x, 2); }, ranks(), 32)
                                 .tree(),
                             {}, {0.7}, 2);
  stir(first, {64, 64, 64});
  const auto before = first.sum(), after = regridded<double>(MPI_COMM_WORLD, 32)->sum();
  EXPECT_NEAR(after.mass, before.mass, 1e-10);
  for (int d = 0; d < 3; ++d) EXPECT_NEAR(after.momentum[d], before.momentum[d], 1e-10);
}

TEST(Levels, EveryLayoutAndDeviceGivesTheSameBits) {
  EXPECT_EQ(regridded<float>(MPI_COMM_SELF, 32)->fingerprint(),
            regridded<float>(MPI_COMM_WORLD, 16)->fingerprint());
  const Int3 n{64, 48, 48};
  const auto level = [](Int3 x) { return bent(x, 2); };
  Sides walls = all({SideKind::bounce, {}, 0});
  walls[0] = walls[1] = {};
  walls[4] = {SideKind::free_slip, {}, 0}, walls[3].velocity = {0.02, 0, 0.01};
  Sides open = walls;
  open[0] = {SideKind::bounce, {0.03, 0, 0}, 0}, open[1] = {SideKind::pressure, {}, 0.01};
  for (const Sides& sides : {Sides{}, walls, open}) {
    const LevelledCut large(n, 8, level), small(n, 8, level, 1, 8), dealt(n, 8, level, ranks(), 16);
    const std::uint64_t alone = stirred<float>(large.tree(), sides, MPI_COMM_SELF);
    EXPECT_EQ(alone, stirred<float>(small.tree(), sides, MPI_COMM_SELF));
    EXPECT_EQ(alone, stirred<float>(dealt.tree(), sides, MPI_COMM_WORLD));
    const std::uint64_t in_double = stirred<double>(large.tree(), sides, MPI_COMM_SELF);
    EXPECT_EQ(in_double, stirred<double>(dealt.tree(), sides, MPI_COMM_WORLD));
    for (const Device device : {Device::host, Device::gpu}) {
      if (!unusable(device).empty()) continue;
      EXPECT_EQ(alone, stirred<float>(dealt.tree(), sides, MPI_COMM_WORLD, device));
      EXPECT_EQ(in_double, stirred<double>(small.tree(), sides, MPI_COMM_SELF, device));
    }
  }
}

TEST(Levels, BordersBetweenTwoOtherRanksNeedNotBeSeen) {
  const auto rank_at = [](Int3 x) { return x.z / 16; };
  const auto level = [&](Int3 x) {
    if (std::abs(rank_at(x) - parallel::rank_of(MPI_COMM_WORLD)) > 1) return -1;  // not known here
    return x.x >= 16 && x.x < 32 && x.z >= 16 ? 0 : 1;
  };
  const LevelledCut cut({48, 16, 16 * ranks()}, 8, level, ranks(), 1 << 30, rank_at);
  LevelledFlow<double> flow(cut.tree(), all({SideKind::bounce}), {0.8, 1.0 / 6}, 1);
  stir(flow, {48, 16, 16 * ranks()});
  const double before = flow.sum().mass;
  flow.step(4);
  EXPECT_NEAR(flow.sum().mass, before, 1e-11);
}

TEST(Levels, StreamThroughBordersLastsAtLowViscosity) {
  const LevelledCut cut(
      {48, 48, 48}, 8, [](Int3 x) { return bent(x, 2); }, ranks());
  LevelledFlow<float> flow(cut.tree(), {}, {0.525, 1.0 / 6}, 2);
  const Vector stream = {0.08, 0.024, 0.016};
  std::uint32_t random = 1;
  flow.set([&](const Vector&, double&, Vector& u, std::array<Vector, 3>&) {
    for (int d = 0; d < 3; ++d) {
      random = random * 1664525 + 1013904223;
      u[d] = stream[d] + 1e-4 * (random * 0x1p-32 - 0.5);
    }
  });
  flow.step(800);
  flow.for_all([&](Fluid<float>& fluid, int b, Int3 x, const Vector&, int) {
    const auto u = fluid.velocity(fluid.moments(b, x));
    for (int d = 0; d < 3; ++d) ASSERT_NEAR(u[d], stream[d], 2e-5);
  });
}

}  // namespace
}  // namespace silt::lbm
