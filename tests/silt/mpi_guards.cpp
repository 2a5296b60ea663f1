// Guards tell on every rank alike, in the same step, what goes wrong, with a cure that works: bodies that
// gain energy, overlaps, and flows and bodies that run away. They leave alone what is sound.
#include <gtest/gtest.h>
#include <mpi.h>

#include <functional>
#include <limits>

#include "coupler/flow.hpp"
#include "silt/guard.hpp"
#include "silt/simulation.hpp"
#include "tests/errors.hpp"
#include "tests/silt/case/case_text.hpp"
#include "tests/silt/gas.hpp"
#include "tests/world.hpp"

namespace silt::testing {
namespace {

using rigid::Vec3;

struct Fault {
  std::string name;
  CaseText text;
  std::function<void(Simulation&)> act = [](Simulation&) {};  // before the first step
  std::string told;                                           // part of what is said
};

/// Gives a body a velocity that a case may not have.
void shoot(Simulation& s, rigid::BodyId id, const Vec3& velocity) {
  if (const std::size_t row = s.bodies().row_of(id); row < s.bodies().owned)
    s.bodies().set_velocity(row, velocity, Vec3::Zero());
  s.scene().exchange->relocate(s.bodies());
}

CaseText fluid_of(const std::string& domain, const std::string& lines) {
  CaseText c;
  c.domain = domain;
  c.fluid = "[fluid]\n" + lines;
  c.shapes.clear(), c.bodies.clear();
  return c;
}

CaseText ball_in(const std::string& fluid, double density, const std::string& lines,
                 const std::string& rest) {
  CaseText c;
  c.domain = domain_of({32, 32, 32});
  c.fluid = "[fluid]\n" + fluid;
  c.rest = rest;
  c.bodies = body_of("ball", density, "position = [16.2, 16.1, 16]\n" + lines);
  return c;
}

const std::string implicit = "[coupling]\ntime = \"implicit\"\n",
                  explicit_ = "[coupling]\ntime = \"explicit\"\n";

std::vector<Fault> faults() {
  return {
      {"shear layer at low viscosity",
       fluid_of(domain_of({64, 64, 2}),
                "relaxation_time = 0.501\ninitial = { type = \"shear-layer\", velocity = [0.1, 0, 0], "
                "steepness = 30 }\n"),
       {},
       "the fluid at cell ["},
      {"lid over fluid of low viscosity",
       fluid_of(domain_of({32, 32, 2},
                          "{ x = [{ type = \"moving\", velocity = [0, 0.1, 0] }, \"no-slip\"], y = "
                          "\"no-slip\", z = \"periodic\" }"),
                "relaxation_time = 0.501\n"),
       {},
       "use fluid.collision"},
      {"fluid driven without end",
       fluid_of(domain_of({16, 16, 16}),
                "relaxation_time = 0.50001\ncollision = \"bgk\"\nbody_force = [2e-2, 1e-2, 0]\n"),
       {},
       "moves 0."},
      {"sphere towed through fluid of low viscosity",
       ball_in("relaxation_time = 0.5003\n", 1, "motion = \"prescribed\"\nvelocity = [0.2, 0.08, 0.03]\n",
               ""),
       {},
       "the fluid at cell ["},
      {"light sphere coupled explicitly",
       ball_in("relaxation_time = 0.6\n", 0.05, "", explicit_ + "[gravity]\nacceleration = [0, 0, -1e-4]\n"),
       {},
       "coupling.time = \"implicit\""},
      {"sphere shot into fluid at rest", ball_in("relaxation_time = 0.55\n", 5, "", implicit),
       [](Simulation& s) { shoot(s, 1, Vec3(0.45, 0.2, 0)); }, "the body moves 0."},
      {"sphere faster than its neighbours see", ball_in("relaxation_time = 0.8\n", 5, "", implicit),
       [](Simulation& s) { shoot(s, 1, Vec3(2, 0.3, 0)); }, "step 1: body 1 moves 2."},
      {"sphere that falls in a deep shaft without drag",
       [] {
         CaseText c = ball_in("relaxation_time = 0.8\n", 50, "", "[gravity]\nacceleration = [0, 0, -2e-2]\n");
         return c;
       }(),
       {},
       "the body moves 0."},
  };
}

struct End {
  std::int64_t step = 0;
  std::string text;
};

/// Returns where a run ends; `exhaustive`: or the first step after which a cell is faster than sound.
End end_of(const Fault& fault, MPI_Comm comm, bool exhaustive) {
  constexpr int steps = 20000;
  Simulation s = fault.text.start(comm, {"run.steps=20000"});
  if (fault.act) fault.act(s);
  End end;
  try {
    for (int step = 0; step < steps; ++step) {
      s.step();
      if (exhaustive && !(s.scene().flow->totals().max_speed <= lbm::speed_of_sound)) break;
    }
  } catch (const CommonGuardStop& stop) {
    end.text = stop.what();
  } catch (const std::overflow_error&) {  // what the look itself meets
    if (!exhaustive) throw;
  }
  end.step = s.steps_done();
  return end;
}

TEST(FaultWatch, StopsWithinTenStepsOfTheOnsetOnEveryRankAlike) {
  for (const Fault& fault : faults()) {
    SCOPED_TRACE(fault.name);
    const End found = end_of(fault, MPI_COMM_WORLD, false);
    EXPECT_TEXT(found.text, fault.told);
    const std::size_t all = std::hash<std::string>()(found.text),
                      alone = tests::alone([&] {
                        const End once = end_of(fault, MPI_COMM_SELF, false),
                                  onset = end_of(fault, MPI_COMM_SELF, true);
                        EXPECT_EQ(found.step, once.step);
                        EXPECT_LE(found.step - onset.step, 10);
                        printf("%s: onset %ld, stopped %ld\n  %s\n", fault.name.c_str(), long(onset.step),
                               long(found.step), found.text.c_str());
                        return std::hash<std::string>()(once.text);
                      });
    EXPECT_EQ(all, alone) << found.text;
  }
}

std::string stop_of(Simulation&& simulation, std::int64_t steps) {
  return tests::error_of<CommonGuardStop>([&] { simulation.run(steps); });
}

/// Fluid that is driven past a warm ball, until it carries heat faster than heat spreads.
CaseText warm_ball_in_a_stream() {
  CaseText c = ball_in("relaxation_time = 0.8\nbody_force = [3e-4, 2e-4, 0]\n", 1,
                       "motion = \"fixed\"\ntemperature = 1\n", "[heat]\nthermal_diffusivity = 1e-4\n");
  c.domain = domain_of({20, 20, 20});
  return c;
}

TEST(TemperatureGuard, TellsOfWavesOnEveryRankAlike) {
  constexpr int steps = 1000;
  const CaseText c = warm_ball_in_a_stream();
  const std::string found = stop_of(c.start(MPI_COMM_WORLD), steps);
  EXPECT_TEXT(found, "has a temperature of ");
  EXPECT_TEXT(found, "; -1 to 2 are possible; ");
  EXPECT_TEXT(found, "waves of temperature grow: use smaller cells");
  const std::size_t alone =
      tests::alone([&] { return std::hash<std::string>()(stop_of(c.start(MPI_COMM_SELF), steps)); });
  EXPECT_EQ(std::hash<std::string>()(found), alone) << found;
  EXPECT_EQ(stop_of(c.start(MPI_COMM_WORLD, {"heat.thermal_diffusivity=0.02"}), 480), "");
}

/// A temperature on which no force depends spoils nothing else.
TEST(TemperatureGuard, TellsOfWhatIsNotANumber) {
  for (const char* device : {"run.device=cpu", "run.device=host"}) {
    Simulation s = warm_ball_in_a_stream().start(MPI_COMM_WORLD, {"fluid.body_force=[0, 0, 0]", device});
    coupler::FluidFields& fields = s.scene().flow->fields();
    const double none = std::numeric_limits<double>::quiet_NaN();
    if (fields.blocks() > 0) fields.write(0, {{1, 1, 1}, {1, 1, 1}}, lbm::D3Q19::directions, &none);
    EXPECT_TEXT(stop_of(std::move(s), 96), "has a temperature that is not a number");
  }
}

TEST(EnergyGuard, AGasByFfdIsStoppedOnEveryRankAndBySffdGoesOn) {
  const CaseText c = gas();
  const Overrides ffd{"contacts.resolver=ffd"};
  constexpr int steps = 1000;
  const std::string found = stop_of(c.start(MPI_COMM_WORLD, ffd), steps);
  EXPECT_TEXT(found, "energy of the bodies has grown by");
  EXPECT_TEXT(found, "use \"sffd\"");
  const std::size_t alone =
      tests::alone([&] { return std::hash<std::string>()(stop_of(c.start(MPI_COMM_SELF, ffd), steps)); });
  EXPECT_EQ(std::hash<std::string>()(found), alone) << found;
  EXPECT_EQ(stop_of(c.start(MPI_COMM_WORLD), steps), "");
}

TEST(EnergyGuard, WhatAProgramDoesIsNoGain) {
  Simulation simulation = gas().start(MPI_COMM_WORLD);
  simulation.run(50);
  for (rigid::BodyId id = 1; id <= 25; ++id) simulation.set_velocity(id, Vec3(0, 0.2, 0), Vec3::Zero());
  simulation.run(50);
  for (int i = 0; i < 50; ++i) {
    simulation.add_force(7, Vec3(0, 0.1, 0));
    simulation.step();
  }
  simulation.run(50);
}

TEST(EnergyGuard, BodiesThatComeBringTheirEnergy) {
  CaseText c = gas();
  c.domain =
      domain_of({20, 20, 40}, "{ x = \"periodic\", y = \"periodic\", z = [\"no-slip\", \"no-slip\"] }");
  c.rest += "[gravity]\nacceleration = [0, 0, -1e-4]\n[[outflow]]\nbox = [[0, 0, 0], [20, 20, 6]]\n";
  c.bodies = body_of("ball", 1, "position = [10, 10, 10]") +
             fill_of("ball", 1, 4, "every = 20\nvelocity = [0, 0, -0.1]\nbox = [[0, 0, 30], [20, 20, 40]]");
  Simulation simulation = c.start(MPI_COMM_WORLD);
  simulation.run(1000);
  const RunCounters counters = simulation.counters();
  EXPECT_GT(counters.arrived, 50u);
  EXPECT_GT(counters.left, 50u);
}

/// Bodies that overlap deeper than half the width of one: three boxes of an edge of 8 over each other, on
/// them one of an edge of 16; steps of 0.02 sqrt(edge/g).
CaseText tower(double heavy) {
  CaseText c;
  c.domain = domain_of({40, 40, 56}, "\"no-slip\"");
  c.fluid.clear();
  c.rest = "[gravity]\nacceleration = [0, 0, -0.0032]\n[contacts]\nfriction = 0.5\n";
  c.shapes = shape_of("box", "box", "edges = [8, 8, 8]") + shape_of("load", "box", "edges = [16, 16, 16]");
  c.bodies = body_of("box", 1, "positions = [[20, 20, 4], [20, 20, 12], [20, 20, 20]]") +
             body_of("load", heavy, "position = [20, 20, 32.01]");
  return c;
}

TEST(OverlapGuard, IsToldOnEveryRankWithACure) {
  constexpr int steps = 300;  // it is told at 120
  const std::string found = stop_of(tower(1e3).start(MPI_COMM_WORLD), steps);
  EXPECT_TEXT(found, "deeper than half the width of one (4)");
  EXPECT_TEXT(found, "raise contacts.sweeps (now 16) or contacts.substeps (now 1)");
  const std::size_t alone =
      tests::alone([] { return std::hash<std::string>()(stop_of(tower(1e3).start(MPI_COMM_SELF), steps)); });
  EXPECT_EQ(std::hash<std::string>()(found), alone) << found;
  EXPECT_EQ(stop_of(tower(1e3).start(MPI_COMM_WORLD, {"contacts.sweeps=64"}), steps), "");
  EXPECT_EQ(stop_of(tower(1e3).start(MPI_COMM_WORLD, {"contacts.substeps=4"}), steps), "");
  EXPECT_EQ(stop_of(tower(10).start(MPI_COMM_WORLD), steps), "");
}

/// A ball that is locked along its way goes on into the floor: no sweep is of use.
TEST(OverlapGuard, ALockedBodyIsToldOfItsLock) {
  CaseText c;
  c.domain = domain_of({32, 32, 32}, "\"no-slip\"");
  c.fluid.clear();
  c.bodies = body_of("ball", 2, "position = [16, 16, 8]\nvelocity = [0, 0, -0.05]\nlocked = [\"z\"]");
  const std::string found = stop_of(c.start(MPI_COMM_WORLD), 400);
  EXPECT_TEXT(found, "body 1 and the side z-low overlap by 4.");
  EXPECT_TEXT(found, "along a locked axis a body keeps its velocity");
  EXPECT_FALSE(tests::has_part(found, "contacts.sweeps"));
  EXPECT_EQ(stop_of(c.start(MPI_COMM_WORLD, {"bodies[0].locked=[\"x\", \"y\"]"}), 400), "");
}

}  // namespace
}  // namespace silt::testing
