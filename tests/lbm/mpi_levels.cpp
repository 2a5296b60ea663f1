// Cells of several levels, on any number of ranks: the same bits for every layout, and levels that change.
#include <gtest/gtest.h>

#include <cmath>

#include "tests/lbm/bent_levels.hpp"
#include "tests/lbm/levelled_cut.hpp"
#include "tests/world.hpp"

namespace silt::lbm::testing {
namespace {

using tests::ranks;

template <class T>
std::uint64_t stirred(const CutTree& tree, const Sides& sides, MPI_Comm comm, Device device = Device::cpu) {
  LevelledFlow<T> flow(tree, sides, {0.6, 1. / 6, Collision::trt, {1e-5, 0, 2e-5}}, 2, comm, device);
  flow.for_all([](Fluid<T>& fluid, int b, Int3 x, const Vector& at, int) {
    const double rho = 0.01 * std::sin(at[0] + 2 * at[1]), u = 0.05 * std::cos(at[2] - at[0]);
    set_equilibrium(fluid, b, x, rho, {u, -u, u / 2});
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

}  // namespace
}  // namespace silt::lbm::testing
