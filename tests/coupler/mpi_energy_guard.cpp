// Bodies that gain energy though nothing drives them are told of on every rank, in the same step, with a cure
// that works; what a program does and what bodies bring that come is not held against them.
#include <gtest/gtest.h>
#include <mpi.h>

#include "coupler/guard.hpp"
#include "coupler/simulation.hpp"
#include "tests/coupler/gas.hpp"
#include "tests/world.hpp"

namespace silt::coupler::testing {
namespace {

using rigid::Vec3;

std::string stop_of(Simulation&& simulation, std::int64_t steps) {
  try {
    simulation.run(steps);
  } catch (const CommonGuardStop& stop) {
    return stop.what();
  }
  return "";
}

TEST(EnergyGuard, AGasByFfdIsStoppedOnEveryRankAndBySffdGoesOn) {
  const CaseText c = gas();
  const Overrides ffd{"contacts.resolver=ffd"};
  constexpr int steps = 1000;
  const std::string found = stop_of(c.start(MPI_COMM_WORLD, ffd), steps);
  EXPECT_NE(found.find("energy of the bodies has grown by"), std::string::npos) << found;
  EXPECT_NE(found.find("use \"sffd\""), std::string::npos) << found;
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

}  // namespace
}  // namespace silt::coupler::testing
