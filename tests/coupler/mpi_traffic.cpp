// What a step sends, as parallel/traffic.hpp counts it, against counts on paper.
#include <gtest/gtest.h>

#include <fmt/format.h>

#include <algorithm>

#include "coupler/simulation.hpp"
#include "tests/coupler/case/case_text.hpp"

namespace silt::coupler::testing {
namespace {

/// A periodic box of fluid: every step sends the populations that cross the sides of a rank's block, five
/// directions a cell of a side, those across an edge once, to each rank beyond a side or an edge. These alone
/// leave a device and come to it, and how many cells were found to be too fast.
TEST(Traffic, AStepOfFluidSendsWhatLeavesABlock) {
  CaseText text;
  text.domain = domain_of({16, 16, 16});
  text.shapes = text.bodies = "";
  Simulation simulation = text.start(MPI_COMM_WORLD, {"run.device=host"});
  constexpr int steps = 6;
  for (int i = 0; i < steps; ++i) simulation.step();
  const lbm::Int3 n = simulation.scene().flow->fields().block(0).size;
  const auto beyond = [&](int d) { return std::min(16 / n[d] - 1, 2); };  // ranks, along an axis
  std::uint64_t slots = 0, peers = 0;
  for (int d = 0; d < 3; ++d) {
    const int e = (d + 1) % 3, f = (d + 2) % 3;
    peers += beyond(d) + beyond(d) * beyond(e);
    if (beyond(d) > 0) slots += 2 * 5 * n[e] * n[f];
    if (beyond(d) > 0 && beyond(e) > 0) slots -= 4 * n[f];
  }
  const parallel::Traffic& sent = simulation.traffic_in_steps();
  EXPECT_EQ(sent.messages, steps * peers);
  EXPECT_EQ(sent.bytes, steps * slots * sizeof(float));
  EXPECT_EQ(simulation.bus_bytes_in_steps().to_device, sent.bytes);
  EXPECT_EQ(simulation.bus_bytes_in_steps().from_device, sent.bytes + steps * sizeof(std::uint32_t));
  EXPECT_EQ(sent.empty_messages, 0u);
  EXPECT_EQ(sent.blocking_collectives, 0u);
}

/// Spheres of several sizes that go 0.01 cells a step: of all that a step does with their cells and links,
/// what crosses the bus has the size of what changed. On one rank, where no messages do.
TEST(Traffic, OnlyWhatHasChangedCrossesTheBus) {
  for (const int diameter : {6, 10}) {
    CaseText text;
    const int n = 2 * diameter;
    text.domain = domain_of({3 * n, 3 * n, 3 * n});
    text.shapes = sphere_of("ball", diameter);
    text.bodies = "";
    for (int k = 0; k < 27; ++k)
      text.bodies +=
          body_of("ball", 1000,
                  fmt::format("position = [{}, {}, {}]\nvelocity = [0.006, 0.006, 0.005]",
                              n * (0.5 + k % 3) + 0.03 * k, n * (0.5 + k / 3 % 3), n * (0.5 + k / 9)));
    Simulation simulation = text.start(MPI_COMM_SELF, {"run.device=host"});
    constexpr int steps = 27;
    for (int i = 0; i < steps; ++i) simulation.step();
    const BusBytes& bytes = simulation.bus_bytes_in_steps();
    EXPECT_LT(double(bytes.to_device + bytes.from_device) / steps / 27, 1000) << diameter;
  }
}

}  // namespace
}  // namespace silt::coupler::testing
