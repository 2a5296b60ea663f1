// Fluid and bodies with temperatures: the same bits on any number of ranks, and across a change of the cut.
#include <gtest/gtest.h>

#include "silt/case/case.hpp"
#include "silt/simulation.hpp"
#include "tests/silt/case/case_text.hpp"
#include "tests/world.hpp"

namespace silt::coupler::testing {
namespace {

using silt::testing::body_of;
using silt::testing::CaseText;
using silt::testing::domain_of;
using silt::testing::simulation_of;
using silt::testing::sphere_of;

/// Balls of every kind to heat that fall through buoyant fluid, and touch.
std::uint64_t hash_of_warm_balls(MPI_Comm comm, const std::string& blocks, const std::string& precision) {
  CaseText c;
  c.domain = domain_of({24, 20, 36},
                       "{ x = \"periodic\", y = \"periodic\", z = [{ type = \"no-slip\", temperature = 1 }, "
                       "\"no-slip\"] }") +
             blocks;
  c.fluid = "[fluid]\nrelaxation_time = 0.7\nprecision = \"" + precision + "\"\n";
  c.shapes = sphere_of("ball", 7);
  const auto ball = [](const char* name, const char* position, const char* heat) {
    return body_of("ball", 2,
                   std::string("name = \"") + name +
                       "\"\nvelocity = [0.02, -0.01, 0.005]\nposition = " + position + "\n" + heat);
  };
  c.bodies = ball("warm", "[6.1, 5.2, 20.3]", "temperature = 2\n") +
             ball("insulating", "[16.2, 5.4, 18.1]", "") +
             ball("light", "[6.4, 14.2, 12.3]", "temperature = -1\nheat_capacity = 0.01\n") +
             ball("heavy", "[17.2, 13.9, 28.3]", "temperature = 3\nheat_capacity = 2\nheat_source = 0.1\n");
  c.rest = "[heat]\nprandtl = 2\nexpansion = 0.1\n[gravity]\nacceleration = [0, 0, -1e-4]\n";
  Simulation s = simulation_of(c.text(), comm);
  while (s.steps_done() < 150) s.step();
  EXPECT_GT(s.counters().uncovered, 0u);
  return s.hash();
}

TEST(WarmBalls, AreTheSameOnAnyRanks) {
  for (const char* precision : {"single", "double"}) {
    const std::uint64_t alone =
        tests::alone([&] { return hash_of_warm_balls(MPI_COMM_SELF, "", precision); });
    EXPECT_EQ(alone, hash_of_warm_balls(MPI_COMM_WORLD, "", precision));
    EXPECT_EQ(alone, hash_of_warm_balls(MPI_COMM_WORLD, "blocks = [12, 20, 9]\n", precision));
  }
}

/// Insulating balls, face-centred between a warm and a cold plane: pockets have links of several blocks.
std::uint64_t hash_of_insulating_balls(MPI_Comm comm, const std::string& blocks) {
  CaseText c;
  c.domain = domain_of({15, 15, 15},
                       "{ x = \"periodic\", y = \"periodic\", z = [{ type = \"no-slip\", temperature = 1 }, "
                       "\"no-slip\"] }") +
             blocks;
  c.shapes = sphere_of("ball", 7.8);
  c.bodies.clear();
  for (const char* position : {"[7.5, 8, 4.1]", "[0.2, 0.5, 4.1]", "[7.5, 0.4, 10.9]", "[0.1, 8.1, 10.9]"})
    c.bodies += body_of("ball", 1, std::string("motion = \"fixed\"\nposition = ") + position + "\n");
  c.rest = "[heat]\nthermal_diffusivity = 0.2\n";
  Simulation s = simulation_of(c.text(), comm);
  while (s.steps_done() < 40) s.step();
  return s.hash();
}

TEST(InsulatingBalls, ConductTheSameOnAnyRanks) {
  const std::uint64_t alone = tests::alone([&] { return hash_of_insulating_balls(MPI_COMM_SELF, ""); });
  for (const char* blocks : {"", "blocks = [5, 15, 5]\n", "blocks = [8, 4, 15]\n"})
    EXPECT_EQ(alone, hash_of_insulating_balls(MPI_COMM_WORLD, blocks)) << blocks;
}

}  // namespace
}  // namespace silt::coupler::testing
