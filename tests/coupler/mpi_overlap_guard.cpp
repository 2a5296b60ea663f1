// Bodies that overlap deeper than half the width of one are told of on every rank, in the same step, with a
// cure that works: a heavy box on light ones, which the sweeps of a step do not carry.
#include <gtest/gtest.h>
#include <mpi.h>

#include "coupler/guard.hpp"
#include "coupler/simulation.hpp"
#include "tests/coupler/case/case_text.hpp"
#include "tests/world.hpp"

namespace silt::coupler::testing {
namespace {

/// Three boxes of an edge of 8 over each other, on them one of an edge of 16; steps of 0.02 sqrt(edge/g).
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

constexpr int steps = 1000;

std::string stop_of(Simulation&& simulation) {
  try {
    simulation.run(steps);
  } catch (const CommonGuardStop& stop) {
    return stop.what();
  }
  return "";
}

TEST(OverlapGuard, IsToldOnEveryRankWithACure) {
  const std::string found = stop_of(tower(1e3).start(MPI_COMM_WORLD));
  EXPECT_NE(found.find("deeper than half the width of one (4)"), std::string::npos) << found;
  EXPECT_NE(found.find("raise contacts.sweeps (now 16) or contacts.substeps (now 1)"), std::string::npos)
      << found;
  const std::size_t alone =
      tests::alone([] { return std::hash<std::string>()(stop_of(tower(1e3).start(MPI_COMM_SELF))); });
  EXPECT_EQ(std::hash<std::string>()(found), alone) << found;
  EXPECT_EQ(stop_of(tower(1e3).start(MPI_COMM_WORLD, {"contacts.sweeps=64"})), "");
  EXPECT_EQ(stop_of(tower(1e3).start(MPI_COMM_WORLD, {"contacts.substeps=4"})), "");
  EXPECT_EQ(stop_of(tower(10).start(MPI_COMM_WORLD)), "");
}

}  // namespace
}  // namespace silt::coupler::testing
