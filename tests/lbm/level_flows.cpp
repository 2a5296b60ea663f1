// Flow through cells of several levels: what passes a border unchanged, and what is conserved.
#include <gtest/gtest.h>

#include <cmath>

#include "tests/lbm/bent_levels.hpp"
#include "tests/lbm/levelled_cut.hpp"
#include "tests/world.hpp"

namespace silt::lbm::testing {
namespace {

using tests::ranks;

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
}  // namespace silt::lbm::testing
