// The figures of [[quantities]] are the same to the bit on any number of ranks and across a checkpoint.
#include <fmt/format.h>

#include <bit>
#include <cmath>

#include "parallel/traffic.hpp"
#include "silt/case/case.hpp"
#include "silt/case/quantity_spec.hpp"
#include "silt/results/definitions.hpp"
#include "tests/silt/case/case_text.hpp"
#include "tests/silt/results/quantity_scenes.hpp"
#include "tests/silt/same_bits.hpp"
#include "tests/world.hpp"

namespace silt::testing {
namespace {

using rigid::Vec3;

/// Every type that looks at bodies, in a crowd: the same bits on any number of ranks and blocks.
CaseText watched_crowd() {
  CaseText c = dry_scene("", "type = \"drift\"", 150);
  c.domain = domain_of({32, 32, 32}, R"({ x = "periodic", y = "periodic", z = ["no-slip", "no-slip"] })");
  c.rest =
      "[gravity]\nacceleration = [1e-3, 0, -3e-3]\n[contacts]\nrestitution = 0.5\nfriction = 0.3\n"
      "[[walls]]\nname = \"pipe\"\ntype = \"tube\"\nradius = 15.9\naxis = \"x\"\npoint = [0, 16, 16]\n";
  c.shapes =
      "[[shapes]]\nname = \"ball\"\ntype = \"sphere\"\nradius = 2.2\n"
      "[[shapes]]\nname = \"brick\"\ntype = \"box\"\nedges = [2, 3, 4]\n";
  c.bodies =
      "[[fill]]\nshape = \"ball\"\ndensity = 2\ncount = 20\ngap = 0.1\n"
      "[[fill]]\nshape = \"brick\"\ndensity = 3\ncount = 20\ngap = 0.1\n";
  int n = 0;
  for (const QuantityType& type : quantity_types) {
    if (type.asks_for(QuantityType::fluid)) continue;
    c.run +=
        "[[quantities]]\nname = \"" + std::to_string(n++) + "\"\ntype = \"" + std::string(type.name) + "\"\n";
    if (type.takes(QuantityType::time)) c.run += "time = 60\n";
    if (type.takes(QuantityType::height)) c.run += "height = 9\n";
    if (type.takes(QuantityType::centre)) c.run += "centre = [16, 16, 16]\n";
    if (type.takes(QuantityType::axis)) c.run += "axis = \"x\"\n";
    if (type.takes(QuantityType::wall)) c.run += "wall = \"pipe\"\n";
    if (type.takes(QuantityType::component)) c.run += "component = \"xz\"\n";
  }
  for (const char* deviation : {"false", "true"})
    c.run += fmt::format(
        "[[quantities]]\nname = \"{}\"\ntype = \"mean-height\"\nover = [20, 120]\ndeviation = {}\n", n++,
        deviation);
  return c;
}

void expect_same_bits(const std::vector<double>& a, const std::vector<double>& b) {
  ASSERT_EQ(a.size(), b.size());
  for (std::size_t i = 0; i < a.size(); ++i)
    EXPECT_EQ(std::bit_cast<std::uint64_t>(a[i]), std::bit_cast<std::uint64_t>(b[i]))
        << "quantity " << i << ": " << a[i] << " and " << b[i];
}

TEST(Quantities, TheSameBitsOnAnyRanks) {
  const CaseText text = watched_crowd();
  expect_same_bits(text.values(MPI_COMM_SELF), text.values(MPI_COMM_WORLD, {finely_cut}));
}

TEST(Quantities, OfFluidTheSameBitsOnAnyRanks) {
  for (const char* quantity : {"kinetic-energy\"", "dissipation\"", "pressure-drop\"\nat = [3, 20.2]",
                               "pressure-drop\"\nat = [3, 20.2]\nover = [5, 15]\ndeviation = true"}) {
    const CaseText text = vortex("type = \"" + std::string(quantity), 20);
    expect_same_bits(text.values(MPI_COMM_SELF), text.values(MPI_COMM_WORLD, {finely_cut}));
  }
}

TEST(Quantities, GoOnFromACheckpoint) {
  Simulation simulation = watched_crowd().start(MPI_COMM_WORLD, {finely_cut});
  const Case& scene = simulation.setup();
  Quantities quantities(scene);
  quantities.observe(simulation);
  for (int i = 0; i < 90; ++i) {
    simulation.step();
    quantities.observe(simulation);
  }
  const Saved saved(simulation, quantities);
  const auto resumed = saved.go_on(scene);
  Quantities again(scene);
  again.set_history(read_history(saved.reader(), scene));
  const auto finish = [&](Simulation& s, Quantities& q) {
    while (s.steps_done() < 150) {
      s.step();
      q.observe(s);
    }
    return numbers(q.evaluate(s));
  };
  expect_same_bits(finish(*resumed, again), finish(simulation, quantities));
}

/// The quantities of a checkpoint that are read again for a case.
std::vector<bool> taken_up(const Saved& saved, const Case& setup) {
  std::vector<bool> taken;
  for (const QuantityHistory& h : read_history(saved.reader(), setup)) taken.push_back(h != no_history);
  return taken;
}

/// Each key of each accumulated quantity, changed alone: what was summed before is dropped, and that of no
/// other quantity; a warning names it. A name that another quantity had is no way to its sums.
TEST(Quantities, OfOtherDefinitionsBeginAnew) {
  using Q = QuantityType;
  const CaseText text = watched_crowd();
  Simulation simulation = text.start(MPI_COMM_WORLD, {finely_cut});
  const Case& scene = simulation.setup();
  Quantities quantities(scene);
  quantities.observe(simulation);
  for (int i = 0; i < 70; ++i) {
    simulation.step();
    quantities.observe(simulation);
  }
  const Saved saved(simulation, quantities);
  const std::vector<bool> before = taken_up(saved, scene);
  EXPECT_TRUE(begun_anew(saved.reader(), scene).empty());
  int changed = 0;
  const auto expect_anew = [&](std::size_t i, const std::string& name, const Overrides& overrides) {
    const Case other = text.read(overrides);
    std::vector<bool> after = before;
    after[i] = false;
    EXPECT_EQ(taken_up(saved, other), after) << overrides.front();
    const auto warnings = begun_anew(saved.reader(), other);
    const bool warns = computation_of(scene.quantities[i].type).gathers() || scene.quantities[i].over;
    ASSERT_EQ(warnings.size(), warns) << overrides.front();
    if (warns) {
      EXPECT_TEXT(warnings[0].text, "'" + name + "'");
    }
    ++changed;
  };
  for (std::size_t i = 0; i < scene.quantities.size(); ++i) {
    if (!before[i]) continue;
    const std::string name = scene.quantities[i].name;
    const QuantityType& type = quantity_type(scene.quantities[i].type);
    for (const auto& [key, value] : {std::pair(Q::axis, "axis=\"y\""),
                                     {Q::time, "time=61"},
                                     {Q::height, "height=10"},
                                     {Q::centre, "centre=[16, 15, 16]"},
                                     {Q::body, "body=\"brick\""}})
      if (type.takes(key)) expect_anew(i, name, {fmt::format("quantities[{}].{}", i, value)});
    expect_anew(i, "other", {fmt::format("quantities[{}].name=\"other\"", i)});
  }
  EXPECT_GT(changed, 30);
}

/// An instant that is over when a run goes on has no value, and not that of another one.
TEST(Quantities, AnInstantBeforeAResumeHasNoValue) {
  const CaseText text = vortex("type = \"kinetic-energy\"\ntime = 5", 12);
  Simulation simulation = text.start(MPI_COMM_WORLD);
  Quantities quantities(simulation.setup());
  for (int i = 0; i < 9; ++i) {
    simulation.step();
    quantities.observe(simulation);
  }
  const Saved saved(simulation, quantities);
  const auto value = [&](const char* time) {
    const Case scene = text.read({time});
    const auto again = saved.go_on(scene);
    Quantities resumed(scene);
    resumed.set_history(read_history(saved.reader(), scene));
    while (again->steps_done() < 12) {
      again->step();
      resumed.observe(*again);
    }
    return resumed.evaluate(*again).front().second;
  };
  EXPECT_EQ(value("quantities[0].time=5"), quantities.evaluate(simulation).front().second);
  EXPECT_TRUE(std::isnan(value("quantities[0].time=6")));
  EXPECT_EQ(value("quantities[0].time=11"),
            vortex("type = \"kinetic-energy\"\ntime = 11", 12).values(MPI_COMM_WORLD).front());
}

/// A ball in a sheared fluid beside two walls, and every quantity that looks at what the walls bear.
CaseText watched_shear() {
  CaseText c;
  c.domain =
      "[domain]\nsize = [16, 16, 32]\n[domain.boundary]\nx = \"periodic\"\ny = \"periodic\"\n"
      "z = [{ type = \"moving\", velocity = [-0.01, 0, 0] }, { type = \"moving\", velocity = [0.01, 0, 0] "
      "}]\n";
  c.bodies = body_of("ball", 2, "position = [8, 8, 5]");
  c.rest = "[gravity]\nacceleration = [0, 0, -1e-4]\n";
  c.run =
      "[run]\nsteps = 150\n"
      "[[quantities]]\nname = \"stress\"\ntype = \"wall-stress\"\nside = \"z-low\"\naxis = \"z\"\ntime = 20\n"
      "[[quantities]]\nname = \"viscosity\"\ntype = \"relative-viscosity\"\naxis = \"z\"\ntime = 0\n"
      "[[quantities]]\nname = \"energy\"\ntype = \"energy-growth\"\n";
  return c;
}

TEST(Quantities, OfWallsTheSameBitsOnAnyRanks) {
  const CaseText text = watched_shear();
  expect_same_bits(text.values(MPI_COMM_SELF), text.values(MPI_COMM_WORLD, {"domain.blocks=[1, 1, 8]"}));
}

/// No rank waits for another after a step: the sums of many steps are put together while the run goes on, and
/// give the same bits as when every step is summed at once.
TEST(Quantities, ObservedWithoutWaiting) {
  for (const CaseText& text : {watched_crowd(), watched_shear()}) {
    constexpr int steps = 150;
    const auto observed = [&](bool at_once) {
      Simulation simulation = text.start(MPI_COMM_WORLD);
      Quantities quantities(simulation.setup());
      parallel::Traffic sent;
      for (int i = 0; i <= steps; ++i) {
        if (i > 0) simulation.step();
        const parallel::Traffic before = parallel::traffic();
        parallel::begin_step_of_traffic();
        quantities.observe(simulation);
        sent += parallel::traffic() - before;
        if (at_once) quantities.history(simulation);
      }
      if (!at_once) {
        EXPECT_LE(sent.blocking_collectives, 2u) << "outflow-rate asks the counters, once in a run";
        EXPECT_EQ(sent.messages, 0u);
        const std::uint64_t started = (steps + 1) / Quantities::most_steps;
        EXPECT_EQ(sent.collectives_under_way, tests::ranks() > 1 ? started - 1 : 0u)
            << "the last is not over";
      }
      return numbers(quantities.evaluate(simulation));
    };
    expect_same_bits(observed(true), observed(false));
  }
}

}  // namespace
}  // namespace silt::testing
