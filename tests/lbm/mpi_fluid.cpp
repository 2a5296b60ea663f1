// The fluid alone, on any number of ranks: the same bits for every layout and device.
#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <functional>
#include <map>

#include "lbm/blocks/equal_cut.hpp"
#include "tests/lbm/fluid_cells.hpp"
#include "tests/odd_cut.hpp"
#include "tests/world.hpp"

namespace silt::lbm::testing {
namespace {

using tests::ranks;

template <class T>
std::uint64_t fingerprint(Fluid<T>& fluid) {
  Fingerprint hash;
  for_all_cells(fluid, [&](int b, Int3 x, Int3 g) {
    for (int i = 0; i < D3Q19::directions; ++i) hash.add(double(fluid.arriving(b, x, i)), g, i);
  });
  return hash.over(fluid.comm());
}

/// The sides across x of a stirred box: what rows do by themselves, and what they leave to the lists.
struct AcrossRows {
  const char* name;
  SideCondition low, high;
};

const AcrossRows across_rows[] = {
    {"periodic", periodic, periodic},
    {"free slip and no slip", slip, no_slip},
    {"moving wall and outlet", side_condition(SideKind::bounce, {0.001, 0.02, 0.01}),
     side_condition(SideKind::pressure, {}, 1e-3)}};

/// Cuts cells for so many ranks.
using Cutting = std::function<CutTree(Int3 cells, int ranks)>;
Cutting blocks_of(Int3 size) {
  return [=](Int3 cells, int) { return grid_cut(cells, size); };
}

Cutting oddly(int blocks_a_rank, int edge) {
  return [=](Int3 cells, int ranks) { return tests::odd_cut(cells, blocks_a_rank * ranks, edge, ranks); };
}

struct StirredFlow {
  Device device = Device::cpu;
  Collision model = Collision::trt;
  double tau = 0.6, force = 1e-5;
};

/// A stirred box with walls, on the ranks of a communicator.
template <class T>
std::uint64_t stirred(const AcrossRows& across, Int3 cells, const Cutting& cut, int steps,
                      MPI_Comm comm = MPI_COMM_WORLD, const StirredFlow& flow = {}) {
  int size = 1;
  MPI_Comm_size(comm, &size);
  const auto moving = side_condition(SideKind::bounce, {0.03, 0.01, 0});
  const std::array<SideCondition, 6> s{across.low, across.high, periodic, periodic, moving, no_slip};
  Fluid<T> fluid(Domain(cut(cells, size), s, size),
                 {flow.tau, 3. / 16, flow.model, {flow.force, 2 * flow.force, 0}, 0.1}, comm, flow.device);
  for_all_cells(fluid, [&](int b, Int3 x, Int3 g) {
    set_equilibrium(fluid, b, x, 1e-3 * std::sin(g.x + 2.0 * g.y),
                    {0.01 * std::sin(3.0 * g.z), 0.02 * std::cos(2.0 * g.x), 0});
  });
  for (int t = 0; t < steps; ++t) step(fluid);
  return fingerprint(fluid);
}

TEST(Fluid, SameBitsOnEveryDevice) {
  const Int3 n{21, 13, 16};
  std::vector<Device> others = {Device::host};
  if (unusable(Device::gpu).empty()) others.push_back(Device::gpu);
  for (const Device device : others)
    for (const AcrossRows& across : across_rows)
      for (const StirredFlow& flow : {StirredFlow{device, Collision::trt, 0.6, 0},
                                      {device, Collision::bgk, 0.8, 1e-5},
                                      {device, Collision::regularised, 0.51, 0},
                                      {device, Collision::regularised, 0.6, 1e-5}})
        for (const int steps : {20, 21}) {
          SCOPED_TRACE(across.name);
          StirredFlow on_cpu = flow;
          on_cpu.device = Device::cpu;
          EXPECT_EQ(stirred<float>(across, n, equal_cut, steps, MPI_COMM_WORLD, on_cpu),
                    stirred<float>(across, n, equal_cut, steps, MPI_COMM_WORLD, flow));
          EXPECT_EQ(stirred<double>(across, n, equal_cut, steps, MPI_COMM_WORLD, on_cpu),
                    stirred<double>(across, n, blocks_of({5, 7, 4}), steps, MPI_COMM_WORLD, flow));
        }
}

TEST(Fluid, ADeviceSeesTheSameFastCells) {
  const auto fast = [](Device device) {
    Fluid<float> fluid(Domain({9, 5, 20}, {}, std::nullopt, ranks()), {0.6}, MPI_COMM_WORLD, device);
    for_all_cells(fluid, [&](int b, Int3 x, Int3 g) {
      const double speed = g.x == 4 && g.z % 3 == 0 ? 0.7 : g == Int3{7, 2, 16} ? NAN : 0;
      set_equilibrium(fluid, b, x, 0, {speed, 0, 0});
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

TEST(Fluid, EveryPlaneIsWatchedOnceAPeriod) {
  Fluid<float> fluid(Domain({9, 5, 20}, {}, std::nullopt, ranks()), {0.6}, MPI_COMM_WORLD);
  for_all_cells(fluid, [&](int b, Int3 x, Int3) { set_equilibrium(fluid, b, x, 0, {0.7, 0, 0}); });
  std::map<std::pair<int, int>, int> seen;  // by block and plane
  for (int pass = 0; pass < WatchedPlanes::period; ++pass) {
    fluid.stream_collide();
    for (const auto& [block, cell, speed] : fluid.fast_cells()) ++seen[{block, cell.z}];
    fluid.exchange();
  }
  for (int b = 0; b < int(fluid.blocks().size()); ++b)
    for (int z = 0; z < fluid.blocks()[b].size().z; ++z)
      EXPECT_EQ((seen[{b, z}]), fluid.blocks()[b].size().x * fluid.blocks()[b].size().y);
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

}  // namespace
}  // namespace silt::lbm::testing
