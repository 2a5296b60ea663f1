// A start from rest without sound: against the pressure and the accelerations of an incompressible fluid, and
// with the same bits on any ranks.
#include <gtest/gtest.h>
#include <mpi.h>

#include <cmath>
#include <numbers>

#include "coupler/case/case.hpp"
#include "coupler/case/quiet_start_steps.hpp"
#include "coupler/simulation.hpp"
#include "coupler/state_hash.hpp"
#include "tests/coupler/case/case_text.hpp"
#include "tests/coupler/coupled_scenes.hpp"
#include "tests/coupler/same_bits.hpp"
#include "tests/coupler/single_cells.hpp"
#include "tests/world.hpp"

namespace silt::coupler::testing {
namespace {

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

Simulation quiet(const CaseText& text, MPI_Comm comm = MPI_COMM_WORLD, const Overrides& overrides = {}) {
  Simulation simulation = text.start(comm, overrides);
  simulation.start_quietly();
  return simulation;
}

/// Returns the sum over all bodies of a function of a row.
template <class Of>
double sum_of_bodies(const Simulation& s, Of&& of) {
  double mine = 0;
  for (std::size_t row = 0; row < s.bodies().owned; ++row) mine += of(row);
  double all = 0;
  MPI_Allreduce(&mine, &all, 1, MPI_DOUBLE, MPI_SUM, MPI_COMM_WORLD);
  return all;
}

/// A body force in a closed box is balanced by the pressure c_s^2 rho = F z, and nothing moves.
TEST(QuietStart, FluidInAClosedBoxKeepsStill) {
  const double force = -1e-5, height = 32;
  CaseText c;
  c.domain = domain_of({12, 10, 32}, "\"no-slip\"");
  c.fluid += "body_force = [0, 0, -1e-5]\n";
  c.shapes.clear(), c.bodies.clear();
  Simulation s = quiet(c);
  const FluidFields& fields = s.scene().flow->fields();
  for_each_cell(fields, [&](int b, lbm::Int3 x, lbm::Int3 global) {
    double density = 0;
    for (int i = 0; i < lbm::directions; ++i) density += arriving(fields, b, x, i);
    EXPECT_NEAR(density, 3 * force * (global.z + 0.5 - height / 2), 0.01 * 3 * -force * height / 2);
  });
  const double of_sound =
      -force * height * std::numbers::sqrt3 / 4;  // the speed that a loud start would give
  for (int k = 0; k < 5; ++k) {
    s.run(16);
    EXPECT_LT(s.look_at_flow().max_speed, 0.03 * of_sound);
  }
}

/// A sphere begins as one with half the mass of the fluid that it displaces besides its own, however light.
TEST(QuietStart, SpheresBeginWithTheirAddedMass) {
  for (const double density : {0.3, 2., 8.}) {
    Simulation s = quiet(falling(density));
    constexpr int steps = 2;
    for (int k = 0; k < steps; ++k) s.step();
    const double speed = sum_of_bodies(s, [&](std::size_t row) { return s.bodies().velocity[row].z(); });
    const double expected = -(density - 1) / (density + 0.5) * gravity * steps;
    EXPECT_NEAR(speed / expected, 1, 0.05) << "density " << density;
  }
}

/// No volume flows through the cross-sections of a closed box: the momentum of the fluid is less than that of
/// the fluid that bodies displace only by that of sound.
TEST(QuietStart, NoSoundIsSetOff) {
  CaseText c = falling(2, 0.6);
  c.bodies += body_of("ball", 2, "position = [8, 22, 12]") + body_of("ball", 2, "position = [23, 9, 31]");
  const double displaced = std::numbers::pi / 6 * 512, weight = 3 * displaced * gravity;
  const double of_sound = weight * 40 * std::numbers::sqrt3 / 4;  // gained in half of a crossing
  Simulation s = quiet(c);
  for (int k = 0; k < 150; ++k) {
    s.step();
    const double of_bodies =
        sum_of_bodies(s, [&](std::size_t row) { return displaced * s.bodies().velocity[row].z(); });
    EXPECT_LT(std::abs(s.look_at_flow().momentum[2] + of_bodies), 0.2 * of_sound) << "step " << k;
  }
}

/// A body on the floor is carried by the floor, not by pressure.
TEST(QuietStart, BodiesThatRestStayAtRest) {
  CaseText c = falling(2);
  c.bodies = body_of("ball", 2, "position = [16, 16, 4]") + body_of("ball", 2, "position = [16, 16, 12]");
  Simulation s = quiet(c);
  const FlowTotals totals = s.look_at_flow();
  const double of_weight = 3 * gravity * 8;  // density, if pressure carried a ball on its cross-section
  EXPECT_LT(totals.max_density - 1, 0.01 * of_weight);
  s.run(50);
  EXPECT_LT(sum_of_bodies(s, [&](std::size_t row) { return s.bodies().velocity[row].norm(); }),
            1e-3 * gravity);
}

TEST(QuietStart, ChangesTheFluidsPressureAlone) {
  CaseText c = crowd();
  Simulation s = c.start(MPI_COMM_WORLD);
  const auto bodies = [&] { return state_hash(MPI_COMM_WORLD, nullptr, s.bodies()); };
  const std::uint64_t before = bodies();
  s.start_quietly();
  EXPECT_EQ(bodies(), before);
  EXPECT_EQ(s.steps_done(), 0);
  const FlowTotals totals = s.look_at_flow();
  EXPECT_LT(std::abs(totals.momentum[2]), 1e-6);
  EXPECT_GT(totals.max_density - totals.min_density, 1e-3);
  expect_goes_on(s, 9);
}

TEST(QuietStart, HasOneOutcomeOnAnyRanks) {
  const auto start = [](const CaseText& text) {
    return [&text](MPI_Comm comm, const Overrides& cut) { return quiet(text, comm, cut); };
  };
  expect_one_hash(start(crowd()), 6, {"\"auto\"", "[12, 10, 7]"});
  CaseText exact = crowd();
  exact.rest += "[coupling]\nforce = \"exact\"\n";
  expect_one_hash(start(exact), 6, {"\"auto\""});
  CaseText dense = crowd();  // spheres that are coupled in one pass
  dense.bodies = fill_of("sphere", 6, 8, "seed = 4");
  expect_one_hash(start(dense), 6, {"\"auto\"", "[12, 10, 14]"});
}

TEST(QuietStart, HasTheSameBitsOnADevice) {
  const auto hash = [](const Overrides& on) {
    Simulation s = quiet(crowd(), MPI_COMM_WORLD, on);
    s.run(4);
    return s.hash();
  };
  EXPECT_EQ(hash({"run.device=\"host\""}), hash({}));
}

/// On several levels the pressure of a body force is the same line.
TEST(QuietStart, ReachesAllLevels) {
  CaseText c = falling(1.1);
  c.domain = domain_of({48, 48, 64}, "\"no-slip\"");
  c.rest += "[coarsening]\nlevels = 1\ndistance = 6\n";
  c.bodies = body_of("ball", 1.1, "position = [24, 24, 32]");
  Simulation s = quiet(c);
  ASSERT_EQ(quiet_start_steps(s.setup()) % 2, 0);
  const double pressed = s.look_at_flow().max_density - 1;
  EXPECT_GT(pressed, 0);
  s.run(2);
  const double speed = sum_of_bodies(s, [&](std::size_t row) { return s.bodies().velocity[row].z(); });
  EXPECT_NEAR(speed / (-0.1 / 1.6 * gravity * 2), 1, 0.05);
}

TEST(QuietStart, IsForStartsFromRestAlone) {
  const auto steps = [](CaseText c, const std::string& fluid, const std::string& rest) {
    c.fluid += fluid, c.rest = rest;
    return quiet_start_steps(c.read());
  };
  const std::string falls = "[gravity]\nacceleration = [0, 0, -1e-4]\n";
  EXPECT_EQ(steps({}, "", falls), 111);  // 2 . 32 . sqrt 3
  EXPECT_EQ(steps({}, "", ""), 0);
  EXPECT_EQ(steps({}, "quiet_start = false\n", falls), 0);
  EXPECT_EQ(steps({}, "initial = { type = \"uniform\", velocity = [0.01, 0, 0] }\n", falls), 0);
  EXPECT_EQ(steps({}, "initial = { type = \"rest\", noise = 1e-3 }\n", falls), 0);
  EXPECT_EQ(
      steps({}, "", "[gravity]\nacceleration = [0, 0, -1e-4]\nover_time = { table = [[0, 0], [50, 1]] }\n"),
      111);  // little, but something
}

}  // namespace
}  // namespace silt::coupler::testing
