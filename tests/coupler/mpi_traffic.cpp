// The messages of a step against counts on paper, and blocks that a body fills: they take no part in the
// passes, and the fluid beside them does not notice.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <fstream>
#include <memory>
#include <stdexcept>

#include "device/exported_memory.hpp"
#include "device/host_device.hpp"
#include "lbm/blocks/equal_cut.hpp"
#include "lbm/passes/passes.hpp"
#include "lbm/walls/device_links.hpp"
#include "silt/simulation.hpp"
#include "tests/coupler/single_cells.hpp"
#include "tests/silt/case/case_text.hpp"
#include "tests/world.hpp"

namespace silt::coupler::testing {
namespace {

/// A periodic box of fluid: every step sends the populations that cross the sides of a rank's block, five
/// directions a cell of a side, those across an edge once, to each rank beyond a side or an edge. Devices
/// that read one another's memory send where these are; then only the number of fast cells leaves a device.
void check_traffic_of_fluid(Device device) {
  CaseText text;
  const lbm::Int3 cells{16, 16, 24};  // equal blocks on 1, 3, 4 and 8 ranks
  text.domain = domain_of({cells.x, cells.y, cells.z});
  text.shapes = text.bodies = "";
  const std::string name(device_names[int(device)]);
  Simulation simulation = text.start(MPI_COMM_WORLD, {"run.device=" + name});
  constexpr int steps = 6;
  for (int i = 0; i < steps; ++i) simulation.step();
  const lbm::Int3 n = simulation.scene().flow->fields().block(0).size;
  const auto beyond = [&](int d) { return std::min(cells[d] / n[d] - 1, 2); };  // ranks, along an axis
  std::uint64_t slots = 0, peers = 0;
  for (int d = 0; d < 3; ++d) {
    const int e = (d + 1) % 3, f = (d + 2) % 3;
    peers += beyond(d) + beyond(d) * beyond(e);
    if (beyond(d) > 0) slots += 2 * 5 * n[e] * n[f];
    if (beyond(d) > 0 && beyond(e) > 0) slots -= 4 * n[f];
  }
  const parallel::Traffic& sent = simulation.traffic_in_steps();
  EXPECT_EQ(sent.messages, steps * peers);
  const std::size_t of_places = peers * sizeof(ExportedPlace), of_values = slots * sizeof(float);
  EXPECT_EQ(sent.bytes, steps * (device == Device::cpu ? of_values : of_places));
  if (device != Device::cpu) {
    EXPECT_EQ(simulation.bus_bytes_in_steps().to_device, 0u);
    EXPECT_EQ(simulation.bus_bytes_in_steps().from_device, steps * sizeof(std::uint32_t));
  }
  EXPECT_EQ(sent.empty_messages, 0u);
  EXPECT_EQ(sent.blocking_collectives, 0u);
}

TEST(Traffic, AStepOfFluidSendsWhatLeavesABlock) {
  check_traffic_of_fluid(Device::cpu);
  check_traffic_of_fluid(Device::host);
}

/// Spheres of several sizes, some with gaps of a single cell between them, that go 0.01 cells a step: of all
/// that a step does with their cells and links, what crosses the bus has the size of what changed. On one
/// rank, where no messages do.
TEST(Traffic, OnlyWhatHasChangedCrossesTheBus) {
  struct Spheres {
    int diameter, apart;
    double most_bytes;
  };
  for (const auto& [diameter, n, most_bytes] :
       {Spheres{6, 12, 185}, Spheres{10, 20, 205}, Spheres{6, 7, 305}}) {
    CaseText text;
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
    EXPECT_LT(double(bytes.to_device + bytes.from_device) / steps / 27, most_bytes) << diameter << " " << n;
    EXPECT_EQ(bytes.pages, 0u) << diameter << " " << n;
  }
}

/// A ball that never moves, at a corner of a periodic box: its eight images are one body, whose motion goes
/// to the device in each step, and whose sums come back.
TEST(Traffic, ABodyIsOneForTheBusWhateverItsImages) {
  for (const double x : {0., 12.}) {
    CaseText text;
    text.domain = domain_of({24, 24, 24});
    text.shapes = sphere_of("ball", 8);
    text.bodies = body_of("ball", 2, fmt::format("position = [{0}, {0}, {0}]\nmotion = \"fixed\"", x));
    Simulation simulation = text.start(MPI_COMM_SELF, {"run.device=host", "fluid.precision=single"});
    for (int i = 0; i < 4; ++i) simulation.step();  // where slots are is told once for either parity
    const BusBytes before = simulation.bus_bytes_in_steps();
    constexpr int steps = 6;
    for (int i = 0; i < steps; ++i) simulation.step();
    const BusBytes bytes = simulation.bus_bytes_in_steps() - before;
    EXPECT_EQ(bytes.to_device, steps * sizeof(lbm::SurfaceMotion)) << x;
    EXPECT_EQ(bytes.from_device, steps * (sizeof(lbm::LinkSums) + sizeof(std::uint32_t))) << x;
  }
}

TEST(Traffic, PagesOfADeviceThatTheProcessorTouchesAreCounted) {
  constexpr std::size_t page = host_page;
  const std::shared_ptr<void> memory = zeroed_on(Device::host, 8 * page);
  auto* const bytes = static_cast<volatile char*>(memory.get());
  const std::uint64_t before = bus_bytes(Device::host).pages;
  const auto touched = [&] { return bus_bytes(Device::host).pages - before; };
  bytes[0] = 1;
  bytes[page - 1] = 2;
  bytes[5 * page] = 3;
  EXPECT_EQ(touched(), 2u);
  clear_in_turn(Device::host, memory.get(), 1);
  lbm::wait(Device::host);
  EXPECT_EQ(touched(), 2u);
  EXPECT_EQ(bytes[0] + bytes[page - 1] + bytes[5 * page], 0 + 2 + 3);
  EXPECT_EQ(touched(), 4u);
}

/// A box that leaves a channel of 16 cells, driven along x; cut across y into `blocks` cells.
Simulation channel_beside_a_box(const std::string& motion, const std::string& blocks) {
  CaseText c;
  c.domain = domain_of({16, 32, 64}, R"({ x = "periodic", y = ["no-slip", "no-slip"], z = "periodic" })");
  c.fluid = "[fluid]\nrelaxation_time = 0.7\nbody_force = [1e-4, 0, 0]\n";
  c.shapes = shape_of("box", "box", "edges = [15.9, 15.9, 63.9]");
  c.bodies = body_of("box", 2, "position = [8, 24, 32]\n" + motion);
  return c.start(MPI_COMM_WORLD, {"domain.blocks=" + blocks});
}

constexpr const char* whole_height = "[16, 32, 8]";  // fluid in every block
constexpr const char* halves = "[16, 16, 8]";        // the upper ones are full

TEST(IdleBlock, FluidBesideItIsTheSame) {
  const std::string fixed = "motion = \"fixed\"",
                    moving = "motion = \"prescribed\"\nvelocity = [0, -0.03, 0]";
  for (const std::string& motion : {fixed, moving}) {  // moving: cells come free, the blocks wake up
    Simulation a = channel_beside_a_box(motion, whole_height), b = channel_beside_a_box(motion, halves);
    for (int t = 0; t < 40; ++t) a.step(), b.step();
    EXPECT_EQ(a.hash(), b.hash()) << motion;
    EXPECT_GT(a.checked_totals().max_speed, 1e-3);
  }
}

/// The lower half along y for half of the ranks, the upper one, which the box fills, for the others.
lbm::CutTree halves_of_ranks() {
  const int n = tests::ranks();
  std::vector<lbm::Cut> nodes;
  const auto slabs = [&](int leaves) {
    for (int left = leaves; left > 1; --left) nodes.push_back({2, 64 - 64 * (left - 1) / leaves, 1});
  };
  if (n > 1) nodes.push_back({1, 16, n / 2});
  if (n > 1) slabs(n / 2);
  slabs(n - n / 2);
  return {{16, 32, 64}, nodes};
}

TEST(IdleBlock, RanksWithoutAFluidCellTakeNoPart) {
  if (tests::ranks() == 1) return;
  for (const std::string motion :
       {"motion = \"fixed\"", "motion = \"prescribed\"\nvelocity = [0, -0.03, 0]"}) {
    Simulation a = channel_beside_a_box(motion, whole_height), b = channel_beside_a_box(motion, "auto");
    b.repartition(halves_of_ranks());
    for (int t = 0; t < 20; ++t) a.step(), b.step();
    EXPECT_EQ(a.hash(), b.hash()) << motion;
    b.repartition(lbm::equal_cut({16, 32, 64}, tests::ranks()));
    for (int t = 0; t < 20; ++t) a.step(), b.step();
    EXPECT_EQ(a.hash(), b.hash()) << motion;
  }
}

TEST(IdleBlock, KeepsWhatItHolds) {
  Simulation s = channel_beside_a_box("motion = \"fixed\"", halves);
  FluidFields& fields = s.scene().flow->fields();
  const lbm::Int3 middle{8, 8, 4};  // far enough from its neighbours' links
  for (int t = 0; t < 4; ++t) s.step();
  const auto for_full_blocks = [&](auto&& visit) {
    for (int b = 0; b < fields.blocks(); ++b)
      if (!fields.is_fluid(b, middle)) visit(b);
  };
  // cells that collided would spread it
  for_full_blocks([&](int b) { set_arriving(fields, b, middle, 0, 0.25); });
  s.step();
  int full = 0;
  for_full_blocks([&](int b) {
    EXPECT_EQ(arriving(fields, b, middle, 0), 0.25);
    ++full;
  });
  EXPECT_GT(tests::sum_over_ranks(full), 0);
}

/// Returns the bytes of its own memory that this process has touched: what MPI shares between ranks is not in
/// it.
double own_bytes() {
  std::ifstream status("/proc/self/status");
  for (std::string word; status >> word;)
    if (double kilobytes = 0; word == "RssAnon:" && status >> kilobytes) return 1024 * kilobytes;
  throw std::runtime_error("/proc/self/status names no RssAnon");
}

/// Populations of 224 x 224 x 64 cells take 250 MB; fluid is in a tube within 1 of 196 blocks of 16 x 16.
/// What else there is takes half of that on one rank, and more with every rank: with the populations it would
/// be above them.
TEST(IdleBlock, ItsPopulationsTakeNoMemory) {
  CaseText c;
  c.domain = domain_of({224, 224, 64});
  c.fluid = "[fluid]\nrelaxation_time = 0.7\nprecision = \"single\"\nbody_force = [0, 0, 1e-5]\n";
  c.rest = "[[walls]]\ntype = \"tube\"\nradius = 7\naxis = \"z\"\npoint = [56, 56, 0]\n";
  c.shapes = c.bodies = "";
  const double before = own_bytes();
  Simulation s = c.start(MPI_COMM_WORLD, {"domain.blocks=[16, 16, 64]"});
  for (int t = 0; t < 10; ++t) s.step();
  const double grown = tests::sum_over_ranks(own_bytes() - before),
               held = tests::sum_over_ranks(double(s.scene().flow->fields().bytes()));
  EXPECT_GT(held, 240e6);
  EXPECT_LT(grown, held);
  EXPECT_GT(s.checked_totals().max_speed, 1e-5);
}

}  // namespace
}  // namespace silt::coupler::testing
