// Slots go where the lists say, there and back, however they are joined into runs.
#include "lbm/slot_exchange.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <vector>

#include "tests/world.hpp"

namespace silt::lbm {
namespace {

using tests::rank;
using tests::ranks;

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
  explicit Ring(Device device = Device::cpu) : exchange(MPI_COMM_WORLD, 7, device) {
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
  for (const auto& [late, device] :
       {std::pair(false, Device::cpu), {true, Device::cpu}, {false, Device::host}, {true, Device::host}}) {
    Ring ring(device);
    if (late) ring.exchange.hold_back(ring.next), ring.exchange.hold_back(ring.last);
    EXPECT_EQ(ring.exchange.message_bytes(), 6 * sizeof(double));
    EXPECT_EQ(ring.exchange.message_bytes(true), late ? 0 : 6 * sizeof(double));
    const auto mine = filled(rank());
    std::vector<std::vector<double>> there(2, std::vector<double>(40, -1)), back = there;
    ring.run(mine, there, false);
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

}  // namespace
}  // namespace silt::lbm
