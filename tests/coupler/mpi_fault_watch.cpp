// Runs that go wrong in different ways stop on every rank in the same step, with the same words, within ten
// steps of the first in which a look at every cell would find it; what is sound goes on.
#include <gtest/gtest.h>
#include <mpi.h>

#include <functional>

#include "coupler/flow.hpp"
#include "coupler/guard.hpp"
#include "coupler/simulation.hpp"
#include "tests/coupler/case/case_text.hpp"
#include "tests/world.hpp"

namespace silt::coupler::testing {
namespace {

using rigid::Vec3;

struct Fault {
  std::string name;
  CaseText text;
  std::function<void(Simulation&)> act = [](Simulation&) {};  // before the first step
  std::string told;                                           // part of what is said
};

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
       fluid_of(
           domain_of({64, 64, 2}),
           "relaxation_time = 0.501\ninitial = { type = \"shear-layer\", velocity = [0.1, 0, 0], steepness = "
           "30 }\n"),
       {},
       "the fluid at cell ["},
      {"lid over fluid of low viscosity",
       fluid_of(
           domain_of(
               {32, 32, 2},
               "{ x = [{ type = \"moving\", velocity = [0, 0.1, 0] }, \"no-slip\"], y = \"no-slip\", z = "
               "\"periodic\" }"),
           "relaxation_time = 0.501\n"),
       {},
       "use fluid.collision"},
      {"fluid driven without end",
       fluid_of(domain_of({16, 16, 16}),
                "relaxation_time = 0.50001\ncollision = \"bgk\"\nbody_force = [2e-2, 1e-2, "
                "0]\n"),
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
       [](Simulation& s) { s.set_velocity(1, Vec3(0.45, 0.2, 0), Vec3::Zero()); }, "the body moves 0."},
      {"sphere faster than its neighbours see", ball_in("relaxation_time = 0.8\n", 5, "", implicit),
       [](Simulation& s) { s.set_velocity(1, Vec3(2, 0.3, 0), Vec3::Zero()); }, "body 1 moves"},
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

/// Where a run ends; `exhaustive`: or the first step after which a cell is faster than sound.
End end_of(const Fault& fault, MPI_Comm comm, bool exhaustive) {
  constexpr int steps = 20000;
  Simulation s = fault.text.start(comm, {"run.steps=20000"});
  if (fault.act) fault.act(s);
  End end;
  try {
    for (int step = 0; step < steps; ++step) {
      s.step();
      if (exhaustive && !(s.scene().flow->account().totals().max_speed <= lbm::speed_of_sound)) break;
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
    EXPECT_NE(found.text.find(fault.told), std::string::npos) << found.text;
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

}  // namespace
}  // namespace silt::coupler::testing
