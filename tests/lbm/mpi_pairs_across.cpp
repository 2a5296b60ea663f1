// The exchange of slots, and the pairs of populations that cut links read across blocks.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <string>
#include <thread>
#include <vector>

#include "lbm/blocks/equal_cut.hpp"
#include "lbm/exchange/slot_exchange.hpp"
#include "lbm/fluid.hpp"
#include "lbm/walls/pairs_across.hpp"
#include "tests/lbm/fluid_cells.hpp"
#include "tests/odd_cut.hpp"
#include "tests/world.hpp"

namespace silt::lbm {
namespace {

using testing::no_slip;
using testing::periodic;
using testing::slip;
using tests::rank;
using tests::ranks;
using tests::sum_over_ranks;

TEST(SlotList, JoinsSlotsThatFollowAtOneStride) {
  SlotList list;
  for (const std::uint32_t slot : {5u, 6u, 7u, 20u, 17u}) list.add({0, slot});
  for (const std::uint32_t slot : {14u, 11u, 8u}) list.add({0, slot, -3});
  list.add({0, 30, 2, 3}), list.add({0, 36, 2, 2}), list.add({0, 40, 1, 2}), list.add({1, 42});
  std::vector<std::array<int, 4>> runs;
  int slots = 0;
  for (const auto& [r, place] : list.places().pairs()) {
    runs.push_back({int(r.array), int(r.first), r.stride, int(r.length)});
    EXPECT_EQ(place.first, slots);
    slots += int(r.length);
  }
  const std::vector<std::array<int, 4>> expected = {{0, 5, 1, 3},   {0, 20, 1, 1}, {0, 17, 1, 1},
                                                    {0, 14, -3, 3}, {0, 30, 2, 5}, {0, 40, 1, 2},
                                                    {1, 42, 1, 1}};
  EXPECT_EQ(runs, expected);
  EXPECT_EQ(list.slots(), 16u);
  EXPECT_EQ(slots, 16);
}

/// Arrays of a rank: what lies in slot s of array a.
std::vector<std::vector<double>> filled(int of_rank) {
  std::vector<std::vector<double>> arrays(2, std::vector<double>(40));
  for (int a = 0; a < 2; ++a)
    for (int s = 0; s < 40; ++s) arrays[a][s] = 1000 * of_rank + 100 * a + s;
  return arrays;
}

/// A ring: each rank sends the next one a run and single slots, and copies a few backwards.
struct Ring {
  int next = (rank() + 1) % ranks(), last = (rank() + ranks() - 1) % ranks();
  SlotExchange<double> exchange;
  explicit Ring(Device device = Device::cpu, bool may_share = true)
      : exchange(MPI_COMM_WORLD, 7, device,
                 may_share ? ranks_that_share(MPI_COMM_WORLD, device) : std::vector<int>()) {
    exchange.sent(next).add({0, 0, 1, 4}), exchange.sent(next).add({1, 9}), exchange.sent(next).add({1, 3});
    exchange.received(last).add({1, 20, 3, 5}), exchange.received(last).add({0, 33});
    exchange.copied().add({0, 10, 1, 3}, {1, 39, -1, 3});
  }
  void run(const std::vector<std::vector<double>>& from, std::vector<std::vector<double>>& to, bool back) {
    const double* sources[] = {from[0].data(), from[1].data()};
    double* targets[] = {to[0].data(), to[1].data()};
    exchange.start(sources, back), exchange.progress(), exchange.finish(sources, targets, back);
  }
};

TEST(SlotExchange, MovesSlotsAndBack) {
  struct Variant {
    bool late, may_share;
    Device device;
  };
  for (const auto& [late, may_share, device] : {Variant{false, true, Device::cpu},
                                                {true, true, Device::cpu},
                                                {false, true, Device::host},
                                                {true, true, Device::host},
                                                {false, false, Device::host},
                                                {true, false, Device::host}}) {
    Ring ring(device, may_share);
    if (late) ring.exchange.hold_back(ring.next), ring.exchange.hold_back(ring.last);
    EXPECT_EQ(ring.exchange.message_bytes(), 6 * sizeof(double));
    EXPECT_EQ(ring.exchange.message_bytes(true), late ? 0 : 6 * sizeof(double));
    const auto mine = filled(rank());
    std::vector<std::vector<double>> there(2, std::vector<double>(40, -1)), back = there;
    const BusBytes before = bus_bytes(device);
    ring.run(mine, there, false);
    const BusBytes crossed = bus_bytes(device) - before;
    EXPECT_EQ(crossed.from_device, device == Device::host && may_share ? 0 : 6 * sizeof(double));
    const auto theirs = filled(ring.last);
    for (int n = 0; n < 4; ++n) EXPECT_EQ(there[1][20 + 3 * n], theirs[0][n]);
    EXPECT_EQ(there[1][32], theirs[1][9]);
    EXPECT_EQ(there[0][33], theirs[1][3]);
    for (int n = 0; n < 3; ++n) EXPECT_EQ(there[1][39 - n], mine[0][10 + n]);
    ring.run(there, back, true);
    for (const int s : {0, 1, 2, 3, 10, 11, 12}) EXPECT_EQ(back[0][s], mine[0][s]);
    EXPECT_EQ(back[1][9], mine[1][9]);
    EXPECT_EQ(back[1][3], mine[1][3]);
    EXPECT_EQ(std::count(back[0].begin(), back[0].end(), -1), 33);
    EXPECT_EQ(std::count(back[1].begin(), back[1].end(), -1), 38);
  }
}

/// A rank that is ahead packs new values while the other one has yet to take the last ones, from memory that
/// both devices read. Values go one way, so that only the places of messages keep the ranks together.
TEST(SlotExchange, WaitsUntilSharedMemoryWasRead) {
  const std::vector<int> sharing = ranks_that_share(MPI_COMM_WORLD, Device::host);
  EXPECT_EQ(int(sharing.size()), ranks());  // of one machine
  for (const int sender : {0, 1}) {
    if (ranks() < 2 || rank() > 1) break;
    SlotExchange<double> exchange(MPI_COMM_WORLD, 8, Device::host, sharing);
    for (int n = 1; n < 12; ++n) {
      const std::uint32_t slots = n % 5 == 0 ? 0 : 40 * n;  // in some rounds there is nothing to send
      exchange.clear();
      if (rank() == sender)
        exchange.sent(1 - rank()).add({0, 0, 1, slots});
      else
        exchange.received(1 - rank()).add({0, 0, 1, slots});
      std::vector<double> values(500, rank() == sender ? 100 + n : -1), taken(500, -1);
      const double* const from = values.data();
      double* const to = taken.data();
      exchange.start({&from, 1});
      if (rank() != sender) std::this_thread::sleep_for(std::chrono::milliseconds(5));
      exchange.finish({&from, 1}, {&to, 1});
      EXPECT_EQ(std::count(taken.begin(), taken.end(), 100. + n), rank() == sender ? 0 : slots) << n;
    }
  }
}

TEST(SlotExchange, LeavesOutArraysThatAreNone) {
  for (const Device device : {Device::cpu, Device::host}) {
    Ring ring(device);
    const auto mine = filled(rank());
    std::vector<double> zeroth(40, -1);
    const double* sources[] = {mine[0].data(), mine[1].data()};
    double* targets[] = {zeroth.data(), nullptr};
    ring.exchange.start(sources), ring.exchange.finish(sources, targets);
    EXPECT_EQ(zeroth[33], filled(ring.last)[1][3]);
    EXPECT_EQ(std::count(zeroth.begin(), zeroth.end(), -1), 39);
  }
}

const SideCondition lid{SideKind::bounce, {0.02, -0.01, 0.03}}, outlet{SideKind::pressure, {}, 0.01};

struct Layout {
  std::string name;
  Int3 cells, block_cells;
  std::array<SideCondition, 6> sides;
};
const std::array<SideCondition, 6> all_periodic{};
const std::vector<Layout> layouts = {
    {"blocks of different sizes", {7, 9, 10}, {3, 4, 4}, all_periodic},
    {"rows that span a period",
     {6, 9, 10},
     {6, 5, 3},
     {periodic, periodic, lid, no_slip, periodic, periodic}},
    {"rows between walls, planes that span a period",
     {8, 5, 12},
     {8, 5, 1},
     {lid, no_slip, periodic, periodic, periodic, periodic}},
    {"inlet, outlet and slip", {8, 5, 12}, {4, 5, 3}, {lid, outlet, periodic, periodic, slip, no_slip}},
    {"blocks that span two periods", {5, 4, 16}, {5, 4, 2}, all_periodic},
    {"blocks one cell thick", {4, 8, 6}, {4, 1, 3}, all_periodic},
    {"blocks of one cell", {3, 3, 4}, {1, 1, 1}, {no_slip, slip, periodic, periodic, periodic, periodic}},
    {"a domain one cell thick", {9, 1, 12}, {4, 1, 4}, all_periodic}};

/// A number in [-0.01, 0.01), of a cell and direction.
double disturbance(Int3 x, int i) {
  std::uint64_t h = std::uint64_t(((x.z * 1009 + x.y) * 1009 + x.x) * 19 + i + 1) * 0x9E3779B97F4A7C15u;
  h ^= h >> 31, h *= 0xBF58476D1CE4E5B9u, h ^= h >> 29;
  return 0.02 * (double(h >> 11) * 0x1p-53 - 0.5);
}

/// One population of each cell and direction of the domain, known to all ranks.
class Populations {
 public:
  template <class T, class Get>  // get(block, local cell, direction)
  Populations(const Fluid<T>& fluid, Get&& get) : cells_(fluid.domain().cells()) {
    values_.resize(std::size_t(cells_.x) * cells_.y * cells_.z * D3Q19::directions);
    for (int b = 0; b < int(fluid.blocks().size()); ++b) {
      const CellBox& box = fluid.blocks()[b].box();
      for_cells({}, box.size, [&](Int3 x) {
        for (int i = 0; i < D3Q19::directions; ++i) values_[index(box.lower + x, i)] = get(b, x, i);
      });
    }
    MPI_Allreduce(MPI_IN_PLACE, values_.data(), int(values_.size()), MPI_DOUBLE, MPI_SUM, fluid.comm());
  }
  double at(Int3 cell, int i) const { return values_[index(cell, i)]; }

 private:
  std::size_t index(Int3 x, int i) const {
    return ((std::size_t(x.z) * cells_.y + x.y) * cells_.x + x.x) * D3Q19::directions + i;
  }
  Int3 cells_;
  std::vector<double> values_;
};

struct Count {
  int right = 0, wrong = 0;
};

/// A third of the cells of a domain, and what is beyond its sides.
struct Solid {
  const Domain& domain;
  bool at(Int3 cell) const {
    const Int3 x = domain.wrapped(cell);
    return !domain.inside(x) || disturbance(x, 0) < -0.01 / 3;
  }
  bool cuts(Int3 cell, int i) const { return !at(cell) && at(cell + D3Q19::c[i]); }
  std::uint64_t cells_from(Int3 cell, int axis) const {
    std::uint64_t bits = 0;
    for (int n = 0; n < 64; ++n, ++cell[axis]) bits |= std::uint64_t(at(cell)) << n;
    return bits;
  }
};

/// Compares the pairs that cut links read, or all if there is nothing solid, with the populations after
/// collision (`sent`). What comes from beyond a side of the domain is what its block has (`arrived`).
template <class T>
Count compare(const Fluid<T>& fluid, const PairsAcross<T>& pairs, const Solid* solid, const Populations& sent,
              const Populations& arrived) {
  const Domain& domain = fluid.domain();
  Count count;
  for (int b = 0; b < int(fluid.blocks().size()); ++b) {
    const CellBox& box = fluid.blocks()[b].box();
    const PlacesAcross<D3Q19> place(box.size);
    for_cells({}, box.size, [&](Int3 x) {
      for (int i = 1; i < D3Q19::directions; ++i) {
        const Int3 near = domain.wrapped(box.lower + x - D3Q19::c[i]),
                   far = domain.wrapped(near - D3Q19::c[i]);
        if (CellBox{{}, box.size}.contains(x - D3Q19::c[i]) || !domain.inside(near)) continue;
        if (solid && !solid->cuts(box.lower + x, i)) continue;
        const BeyondPair<T> pair = pairs.of(b)[place(x, i)];
        const double toward = domain.inside(far) ? sent.at(far, i) : arrived.at(near, i);
        const bool right = pair.away == sent.at(near, opposite(i)) && pair.toward == toward;
        ++(right ? count.right : count.wrong);
      }
    });
  }
  return count;
}

template <class T>
void pairs_are_right(const Layout& layout, const CutTree& cut, bool chosen) {
  SCOPED_TRACE(layout.name);
  Fluid<T> fluid(Domain(cut, layout.sides, ranks()), {0.8, 3. / 16, Collision::trt, {1e-4, -2e-4, 3e-4}},
                 MPI_COMM_WORLD);
  const auto blocks = std::span<const Block<T>>(fluid.blocks());
  PairsAcross<T> pairs(fluid.domain(), fluid.comm(), blocks);
  const Solid solid{fluid.domain()};
  if (chosen)
    pairs.choose([&](int b, Int3 x, int axis) { return solid.cells_from(blocks[b].box().lower + x, axis); });
  for (int b = 0; b < int(blocks.size()); ++b)
    for_cells({}, blocks[b].size(), [&](Int3 x) {
      for (int i = 0; i < D3Q19::directions; ++i)
        fluid.arriving(b, x, i) = T(disturbance(blocks[b].box().lower + x, i));
    });
  for (int step = 0; step < 4; ++step) {
    fluid.stream_collide();
    const Populations sent(fluid, [&](int b, Int3 x, int i) { return fluid.leaving(b, x, i); });
    fluid.exchange();
    const Populations arrived(fluid, [&](int b, Int3 x, int i) { return fluid.arriving(b, x, i); });
    pairs.exchange(blocks, fluid.parity());
    const Count count = compare(fluid, pairs, chosen ? &solid : nullptr, sent, arrived);
    EXPECT_EQ(count.wrong, 0) << "of " << count.wrong + count.right << " after step " << step;
    EXPECT_GT(sum_over_ranks(count.right), 0);
  }
}

TEST(PairsAcross, AreThePopulationsAfterCollision) {
  for (const Layout& layout : layouts) {
    for (const bool chosen : {false, true}) {
      pairs_are_right<float>(layout, grid_cut(layout.cells, layout.block_cells), chosen);
      pairs_are_right<double>(layout, grid_cut(layout.cells, layout.block_cells), chosen);
      pairs_are_right<float>(layout, tests::odd_cut(layout.cells, 2 * ranks(), 1), chosen);
    }
  }
}

TEST(PairsAcross, MoveTwiceTheBytesOfTheHalo) {
  for (const Layout& layout : layouts) {
    if (std::any_of(layout.sides.begin(), layout.sides.end(),
                    [](const SideCondition& s) { return s.kind != SideKind::periodic; }))
      continue;
    SCOPED_TRACE(layout.name);
    Fluid<float> fluid(Domain(layout.cells, layout.sides, layout.block_cells, ranks()), {}, MPI_COMM_WORLD);
    const PairsAcross<float> pairs(fluid.domain(), fluid.comm(), fluid.blocks());
    EXPECT_EQ(sum_over_ranks(double(pairs.message_bytes())),
              2 * sum_over_ranks(double(fluid.halo().message_bytes())));
  }
}

TEST(PairsAcross, MoveForCutLinksAlone) {
  for (const Layout& layout : layouts) {
    SCOPED_TRACE(layout.name);
    Fluid<float> fluid(Domain(layout.cells, layout.sides, layout.block_cells, ranks()), {}, MPI_COMM_WORLD);
    const Domain& domain = fluid.domain();
    const Solid solid{domain};
    PairsAcross<float> pairs(domain, fluid.comm(), fluid.blocks());
    pairs.choose(
        [&](int b, Int3 x, int axis) { return solid.cells_from(fluid.blocks()[b].box().lower + x, axis); });
    int read = 0;  // from other ranks
    for (const Block<float>& block : fluid.blocks())
      for_cells({}, block.size(), [&](Int3 x) {
        for (int i = 1; i < D3Q19::directions; ++i) {
          const Int3 cell = block.box().lower + x, near = domain.wrapped(cell - D3Q19::c[i]);
          read += domain.inside(near) && domain.block_at(near).rank != tests::rank() && solid.cuts(cell, i);
        }
      });
    EXPECT_EQ(sum_over_ranks(double(pairs.message_bytes())), sum_over_ranks(2. * sizeof(float) * read));
    pairs.choose([](int, Int3, int) { return std::uint64_t{0}; });
    EXPECT_EQ(pairs.message_bytes(), 0u);
  }
}

}  // namespace
}  // namespace silt::lbm
