// A start from rest without sound: against the pressure and the accelerations of an incompressible fluid, and
// with the same bits on any ranks.
#include <gtest/gtest.h>
#include <mpi.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "coupler/state_hash.hpp"
#include "silt/case/case.hpp"
#include "silt/simulation.hpp"
#include "tests/coupler/single_cells.hpp"
#include "tests/silt/case/case_text.hpp"
#include "tests/silt/coupled_scenes.hpp"
#include "tests/silt/same_bits.hpp"
#include "tests/world.hpp"

namespace silt::testing {
namespace {

using namespace coupler;
using namespace coupler::testing;

constexpr double gravity = 1e-4;

/// Spheres in a closed box that begin to fall.
CaseText falling(double density, double tau = 0.53) {
  CaseText c;
  c.domain = domain_of({32, 32, 40}, "\"no-slip\"");
  c.fluid = "[fluid]\nrelaxation_time = " + std::to_string(tau) + "\n";
  c.rest = "[gravity]\nacceleration = [0, 0, -1e-4]\n";
  c.shapes = sphere_of("ball", 8);
  c.bodies = body_of("ball", density, "position = [16, 16, 20]");
  return c;
}

struct Quiet : Simulation {
  explicit Quiet(const CaseText& text, MPI_Comm comm = MPI_COMM_WORLD, Overrides overrides = {})
      : Simulation(text.read(quietly(std::move(overrides))), comm) {
    start_quietly();
  }
  static Overrides quietly(Overrides overrides = {}) {
    overrides.push_back("fluid.quiet_start=true");
    return overrides;
  }
};

/// Returns the sum over all bodies of a function of a row.
template <class Of>
double sum_of_bodies(const Simulation& s, Of&& of) {
  double mine = 0;
  for (std::size_t row = 0; row < s.bodies().owned; ++row) mine += of(row);
  double all = 0;
  MPI_Allreduce(&mine, &all, 1, MPI_DOUBLE, MPI_SUM, MPI_COMM_WORLD);
  return all;
}

/// A force of -1e-5 on the fluid, as a body force and as the weight of cold fluid.
const std::string body_force = "body_force = [0, 0, -1e-5]\n",
                  cold =
                      "[gravity]\nacceleration = [0, 0, -1e-4]\n[heat]\nthermal_diffusivity = 0.1\n"
                      "initial = -1\nexpansion = 0.1\n";

/// It is balanced in a closed box by the pressure c_s^2 rho = F z, whatever stands there, and nothing moves:
/// `share` of what a loud start would give.
void expect_still(const std::string& push, const std::string& rest, double share = 0.05) {
  constexpr double force = -1e-5, height = 48;
  CaseText c;
  c.domain = domain_of({32, 32, 48}, "\"free-slip\"");
  c.fluid += push;
  c.rest = rest;
  c.bodies = body_of("ball", 1, "motion = \"fixed\"\nposition = [16, 16, 12]");
  Quiet s(c);
  double off = 0;
  s.scene().flow->for_levels([&](const FluidFields& fields) {
    for_each_cell(fields, [&](int b, lbm::Int3 x, lbm::Int3 global) {
      if (!fields.is_fluid(b, x)) return;
      double density = 0;
      for (int i = 0; i < lbm::D3Q19::directions; ++i) density += arriving(fields, b, x, i);
      off = std::max(off, std::abs(density - 3 * force * (fields.centre(global).z() - height / 2)));
    });
  });
  EXPECT_LT(off, 0.03 * 3 * std::abs(force) * height / 2);
  const double of_sound =
      -force * height * std::numbers::sqrt3 / 4;  // the speed that a loud start would give
  for (int k = 0; k < 5; ++k) {
    s.run(16);
    EXPECT_LT(s.checked_totals().max_speed, share * of_sound);
  }
}

TEST(QuietStart, FluidInAClosedBoxKeepsStill) {
  expect_still(body_force, "");
  expect_still("", cold);
}
TEST(QuietStart, FluidOnTwoLevelsKeepsStill) {
  const std::string levels = "[coarsening]\nlevels = 1\ndistance = 6\n";
  expect_still(body_force, levels);
  expect_still("", cold + levels, 0.1);  // edges of borders between levels stir what a temperature drives
}

/// No volume flows through the cross-sections of a closed box: the momentum of the fluid is less than that of
/// the fluid that bodies displace only by that of sound.
TEST(QuietStart, NoSoundIsSetOff) {
  CaseText c = falling(2, 0.6);
  c.bodies += body_of("ball", 2, "position = [8, 22, 12]") + body_of("ball", 2, "position = [23, 9, 31]");
  const double displaced = std::numbers::pi / 6 * 512, weight = 3 * displaced * gravity;
  const double of_sound = weight * 40 * std::numbers::sqrt3 / 4;  // gained in half of a crossing
  Quiet s(c);
  double loudest = 0;
  for (int k = 0; k < 150; ++k) {
    s.step();
    const double of_bodies =
        sum_of_bodies(s, [&](std::size_t row) { return displaced * s.bodies().velocity[row].z(); });
    loudest = std::max(loudest, std::abs(s.checked_totals().momentum[2] + of_bodies));
  }
  EXPECT_LT(loudest, 0.25 * of_sound);
}

/// A body on the floor is carried by the floor, not by pressure.
TEST(QuietStart, BodiesThatRestStayAtRest) {
  CaseText c = falling(2);
  c.bodies = body_of("ball", 2, "position = [16, 16, 4]") + body_of("ball", 2, "position = [16, 16, 12]");
  Quiet s(c);
  const FlowTotals totals = s.checked_totals();
  const double of_weight = 3 * gravity * 8;  // density, if pressure carried a ball on its cross-section
  EXPECT_LT(totals.max_density - 1, 0.01 * of_weight);
  s.run(50);
  EXPECT_LT(sum_of_bodies(s, [&](std::size_t row) { return s.bodies().velocity[row].norm(); }),
            1e-3 * gravity);
}

/// The crowd in warm fluid, with lumps that are warmer and a wall that warms it.
CaseText crowd_on_a_hot_floor() {
  CaseText c = crowd();
  c.domain = domain_of({24, 20, 28},
                       "{ x = \"periodic\", y = \"periodic\", z = [{ type = \"no-slip\", temperature = 5 }, "
                       "\"free-slip\"] }");
  c.rest += "[heat]\nthermal_diffusivity = 0.1\ninitial = 1\nexpansion = 0.05\n";
  c.bodies += fill_of("sphere", 2, 3, "name = \"lump\"\ntemperature = 3\nheat_capacity = 0.1");
  c.run +=
      "[[quantities]]\nname = \"heat\"\ntype = \"stored-heat\"\n"
      "[[quantities]]\nname = \"lumps\"\ntype = \"body-temperature\"\nbody = \"lump\"\n";
  return c;
}

TEST(QuietStart, KeepsTheTemperature) {
  Simulation s = crowd_on_a_hot_floor().start(MPI_COMM_WORLD, Quiet::quietly());
  const auto now = [&](const char* name) { return Quantities(s.setup()).evaluate(s, name); };
  const double heat = now("heat");
  s.start_quietly();
  EXPECT_EQ(now("lumps"), 3);
  EXPECT_NEAR(now("heat") / heat, 1, 1e-6);
  for_each_cell(s.scene().flow->fields(), [&](int b, lbm::Int3 x, lbm::Int3) {
    EXPECT_NEAR(s.scene().flow->fields().temperature(b, x), 1, 1e-6);
  });
  expect_goes_on(s, 9);
}

TEST(QuietStart, ChangesTheFluidsPressureAlone) {
  CaseText c = crowd();
  c.bodies += body_of("sphere", 2, "position = [4, 5, 14]\nvelocity = [0.01, 0, 0.02]");
  Simulation s = c.start(MPI_COMM_WORLD, Quiet::quietly());
  const auto bodies = [&] { return state_hash(MPI_COMM_WORLD, nullptr, s.bodies()); };
  const std::uint64_t before = bodies(), cells = s.checked_totals().fluid_cells;
  s.start_quietly();
  EXPECT_EQ(bodies(), before);
  EXPECT_EQ(s.steps_done(), 0);
  const FlowTotals totals = s.checked_totals();
  EXPECT_EQ(totals.fluid_cells, cells);
  EXPECT_LT(std::abs(totals.momentum[2]), 1e-6);
  EXPECT_GT(totals.max_density - totals.min_density, 1e-3);
  expect_goes_on(s, 9);
}

/// Returns the state a few steps after a quiet start.
std::uint64_t hash_of(const CaseText& text, MPI_Comm comm, const Overrides& overrides = {}) {
  Quiet s(text, comm, overrides);
  s.run(6);
  return s.hash();
}

TEST(QuietStart, HasOneOutcomeOnAnyRanks) {
  CaseText exact = crowd();
  exact.rest += "[coupling]\nforce = \"exact\"\n";
  CaseText dense = crowd();  // spheres that are coupled in one pass
  dense.bodies = fill_of("sphere", 6, 8, "seed = 4");
  for (const CaseText& text : {crowd(), exact, dense, crowd_on_a_hot_floor()}) {
    const std::uint64_t alone = tests::alone([&] { return hash_of(text, MPI_COMM_SELF); });
    EXPECT_EQ(hash_of(text, MPI_COMM_WORLD), alone);
    EXPECT_EQ(hash_of(text, MPI_COMM_WORLD, {"domain.blocks=[12, 10, 7]"}), alone);
  }
}

TEST(QuietStart, HasTheSameBitsOnADevice) {
  EXPECT_EQ(hash_of(crowd(), MPI_COMM_WORLD, {"run.device=\"host\""}), hash_of(crowd(), MPI_COMM_WORLD));
}

TEST(QuietStart, IsForStartsFromRestAlone) {
  const auto steps = [](CaseText c, const std::string& fluid, const std::string& rest) {
    c.fluid += fluid, c.rest = rest;
    return quiet_start_steps(c.read(Quiet::quietly()));
  };
  const std::string falls = "[gravity]\nacceleration = [0, 0, -1e-4]\n";
  EXPECT_EQ(steps({}, "", falls), 111);  // 2 . 32 . sqrt 3
  EXPECT_EQ(steps({}, "", ""), 0);
  CaseText unasked;
  unasked.rest = falls;
  EXPECT_EQ(quiet_start_steps(unasked.read()), 0);
  EXPECT_EQ(steps({}, "initial = { type = \"uniform\", velocity = [0.01, 0, 0] }\n", falls), 0);
  EXPECT_EQ(steps({}, "initial = { type = \"rest\", noise = 1e-3 }\n", falls), 0);
  EXPECT_EQ(
      steps({}, "", "[gravity]\nacceleration = [0, 0, -1e-4]\nover_time = { table = [[0, 0], [50, 1]] }\n"),
      111);  // little, but something
}

}  // namespace
}  // namespace silt::testing
