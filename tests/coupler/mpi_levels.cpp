// The fluid on cells of several levels: what looks at it between steps sees the cells of all levels, and
// levels that follow bodies change no bit and conserve momentum.
#include <gtest/gtest.h>
#include <mpi.h>

#include <cmath>

#include "coupler/spec/flow_spec.hpp"
#include "coupler/state_hash.hpp"
#include "silt/case/case.hpp"
#include "silt/guard.hpp"
#include "silt/results/quantities.hpp"
#include "silt/results/velocity_gradient.hpp"
#include "silt/simulation.hpp"
#include "tests/coupler/levelled_flow.hpp"
#include "tests/errors.hpp"
#include "tests/silt/case/case_text.hpp"
#include "tests/silt/same_bits.hpp"
#include "tests/world.hpp"

namespace silt::coupler::testing {
namespace {

constexpr int finest_cells = 24 * 16 * 8, of_each_level = finest_cells / 3;

/// A third of the box each is of every level; the values are whole numbers of quanta, so that sums are exact.
TEST(Levels, TotalsCountCellsByTheirVolume) {
  Simulation s = levelled_case("relaxation_time = 0.8\nbody_force = [0.0625, 0, 0]\n").start(MPI_COMM_WORLD);
  LevelledFlow& flow = put_levels(s);
  const auto density = [](int level) { return 0.125 * (1 + level); };
  set_cells(flow, [&](const FluidFields& fields, lbm::Int3) {
    return LocalFlow{density(fields.level()), {0.25, 0, -0.125}};
  });
  const FlowTotals totals = flow.totals();
  EXPECT_EQ(totals.fluid_cells, std::uint64_t(finest_cells));
  EXPECT_NEAR(totals.mass_deviation, of_each_level * (0.125 + 0.25 + 0.375), 1e-9);
  EXPECT_NEAR(totals.momentum[0], 0.25 * finest_cells, 1e-9);
  EXPECT_NEAR(totals.momentum[2], -0.125 * finest_cells, 1e-9);
  EXPECT_EQ(totals.forces, std::uint64_t(of_each_level * (1 + 2 + 4)));
  EXPECT_NEAR(flow.fields().velocity_sum(totals)[0],
              0.25 * finest_cells + 0.5 * 0.0625 * of_each_level * (1 + 2 + 4), 1e-9);
  EXPECT_EQ(totals.max_density, 1.375);
  EXPECT_EQ(totals.min_density, 1.125);
}

TEST(Levels, ACellAtFaultIsNamedInFinestCells) {
  Simulation s = levelled_case().start(MPI_COMM_WORLD);
  LevelledFlow& flow = put_levels(s);
  set_cells(flow, [](const FluidFields& fields, lbm::Int3 cell) {
    const bool fast = fields.level() == 1 && (cell == lbm::Int3{5, 6, 3} || cell == lbm::Int3{6, 6, 3});
    return LocalFlow{fields.level() == 2 && cell == lbm::Int3{1, 2, 1} ? -0.5 : 0, {fast ? 0.5 : 0, 0, 0}};
  });
  const FlowTotals totals = flow.totals();
  EXPECT_EQ(totals.fastest_cell, (lbm::Int3{10, 12, 6}));
  EXPECT_EQ(totals.thinnest_cell, (lbm::Int3{4, 8, 4}));
  EXPECT_TEXT(tests::error_of<CommonGuardStop>([&] { s.checked_totals(); }),
              "the fluid at cell [10, 12, 6], moves 0.5");
}

TEST(Levels, HashIsTheSameOnAnyRanksAndKnowsTheLevel) {
  const auto hash_of = [](MPI_Comm comm, int changed_level) {
    Simulation s = levelled_case().start(comm);
    LevelledFlow& flow = put_levels(s);
    set_cells(flow, [&](const FluidFields& fields, lbm::Int3 cell) {
      const bool changed = fields.level() == changed_level && cell.y == 1 && cell.z == 0;
      return LocalFlow{changed ? 1e-3 : 0, {1e-3 * cell.x, 0, 1e-3 * fields.level()}};
    });
    return s.hash();
  };
  const std::uint64_t everywhere = hash_of(MPI_COMM_WORLD, -1);
  EXPECT_EQ(everywhere, tests::alone([&] { return hash_of(MPI_COMM_SELF, -1); }));
  for (int level = 0; level < 3; ++level) EXPECT_NE(hash_of(MPI_COMM_WORLD, level), everywhere) << level;
  const Case scene = levelled_case().read();
  LevelledFlow fine(scene, lbm::CutTree({8, 8, 8}), 1, MPI_COMM_SELF),
      coarse(scene, {{16, 16, 16}, {}, {{0, 1}}}, 2, MPI_COMM_SELF);
  EXPECT_NE(fine.fields(0).hash(), coarse.fields(1).hash()) << "cells alike but for their width";
}

/// Taylor and Green's vortex: the velocity of every cell is that at its centre, and so is the stress, from
/// which the dissipation follows; the quadratic functions sum to the same on all levels but for the waves'
/// sampling, which is exact for whole periods.
TEST(Levels, AFlowBeginsAtTheCentresOfCells) {
  Simulation s = levelled_case(
                     "relaxation_time = 0.8\ninitial = { type = \"vortex\", velocity = [0.01, 0, 0], swirl = "
                     "0.02, radius = 4 }\n")
                     .start(MPI_COMM_WORLD);
  LevelledFlow& flow = put_levels(s);
  for (int level = 0; level < 3; ++level) set_initial_flow(s.setup(), flow.fields(level));
  flow.for_levels([&](const FluidFields& fields) {
    for_each_fluid_cell(fields, [&](lbm::Int3 cell, const lbm::Moments& m) {
      const double w = fields.width(), x = w * (cell.x + 0.5) - 12, y = w * (cell.y + 0.5) - 8;
      const double turn = 0.02 / 4 * std::exp(0.5 - (x * x + y * y) / 32);
      const auto u = fields.velocity(m);
      EXPECT_NEAR(u[0], 0.01 - turn * y, 1e-12);
      EXPECT_NEAR(u[1], turn * x, 1e-12);
      EXPECT_NEAR(m.density_deviation, -1.5 * 16 * turn * turn, 1e-12);
      const double xx = x * y * turn / 16, xy = 0.5 * (y * y - x * x) * turn / 16;
      EXPECT_NEAR(strain_rate_squared(fields, m), 2 * (xx * xx + xy * xy), 1e-12);
    });
  });
}

constexpr const char* levels = "[coarsening]\nlevels = 2\ndistance = 7\n";

/// Spheres that fly past each other in a periodic box of cells of three levels.
CaseText flying(const std::string& run = "") {
  CaseText c;
  c.domain = domain_of({96, 64, 64});
  c.fluid += "precision = \"double\"\n";
  c.rest = "[coupling]\nforce = \"exact\"\n";
  c.rest += levels;
  c.shapes = sphere_of("sphere", 6.5);
  c.bodies = body_of("sphere", 200, "position = [5.2, 16.1, 7.3]\nvelocity = [0.08, 0.03, 0.0]") +
             body_of("sphere", 100, "position = [67.4, 26.9, 17.9]\nvelocity = [-0.06, 0.0, 0.05]");
  c.run = "[run]\nsteps = 640\n" + run;
  return c;
}

/// The same spheres, one with a temperature of its own and one insulating, in fluid that heat stirs.
CaseText warm(const std::string& precision, const std::string& coarsening = levels) {
  CaseText c = flying();
  c.fluid = CaseText().fluid + "precision = \"" + precision + "\"\n";
  c.rest =
      "[heat]\nthermal_diffusivity = 0.05\ninitial = 0.5\nexpansion = 0.1\n[gravity]\nacceleration = "
      "[0, 0, -1e-4]\n[[quantities]]\nname = \"heat\"\ntype = \"stored-heat\"\n" +
      coarsening;
  c.bodies.replace(c.bodies.find("position"), 0, "name = \"warm\"\ntemperature = 3\nheat_capacity = 0.01\n");
  return c;
}

/// The warm body is fixed in a mean gradient.
CaseText warm_in_a_gradient() {
  CaseText c = warm("single");
  c.rest.replace(c.rest.find("initial"), 0, "mean_gradient = [0.01, 0, 0.02]\n");
  c.bodies.replace(c.bodies.find("velocity = [0.08, 0.03, 0.0]"), 28, "motion = \"fixed\"");
  return c;
}

TEST(WarmLevels, AreTheSameOnAnyRanksAndDevice) {
  for (const auto& [text, steps] : {std::pair(warm("single", ""), 24), std::pair(warm("single"), 112),
                                    std::pair(warm_in_a_gradient(), 112)}) {
    const auto hash = [&](MPI_Comm comm, const std::string& device) {
      Simulation s = text.start(comm, {"run.device=" + device});
      s.run(steps);
      return s.hash();
    };
    const std::uint64_t alone = tests::alone([&] { return hash(MPI_COMM_SELF, "cpu"); });
    EXPECT_EQ(alone, hash(MPI_COMM_WORLD, "cpu")) << text.rest;
    EXPECT_EQ(alone, hash(MPI_COMM_WORLD, "host")) << text.rest;
  }
}

TEST(WarmLevels, GoOnFromACheckpoint) {
  Simulation s = warm("single").start(MPI_COMM_WORLD);
  s.run(68);
  expect_goes_on(s, 60);
}

TEST(WarmLevels, LoseNoHeat) {
  Simulation s = warm("double").start(MPI_COMM_WORLD);
  const auto heat = [&] { return Quantities(s.setup()).evaluate(s, "heat"); };
  const double before = heat();
  const lbm::CutTree cut = s.scene().level_view().tree();
  s.run(112);
  EXPECT_FALSE(s.scene().level_view().tree() == cut);
  EXPECT_NEAR(heat() / before, 1, 1e-9);
}

/// Returns how often this rank's cells were refined or coarsened.
int regrids(Simulation& s, int steps) {
  int changes = 0;
  for (int n = 0; n < steps; ++n) {
    const lbm::CutTree before = s.scene().level_view().tree();
    s.step();
    changes += !(before == s.scene().level_view().tree());
  }
  return changes;
}

TEST(Regrid, RanksAndCutsChangeNoBit) {
  const auto hash_of = [](MPI_Comm comm, const std::string& run) {
    Simulation s = flying(run).start(comm);
    EXPECT_GT(tests::sum_over_ranks(double(regrids(s, 112))), 2);
    return s.hash();
  };
  const std::uint64_t alone = tests::alone([] {
    Simulation s = flying().start(MPI_COMM_SELF);
    s.run(112);
    return s.hash();
  });
  EXPECT_EQ(alone, hash_of(MPI_COMM_WORLD, ""));
  EXPECT_EQ(alone, hash_of(MPI_COMM_WORLD, "balance = { every = 32 }\n"));
}

/// On a device all ranks make the new lists together, even those that see no change: the third of four here.
TEST(Regrid, RanksFarFromAChangeTakePartOnADevice) {
  CaseText c;
  c.domain = domain_of({12, 12, 320});
  c.rest = "[coarsening]\nlevels = 1\ndistance = 6\n";
  c.shapes = sphere_of("sphere", 6.5);
  c.bodies = body_of("sphere", 200, "position = [6.2, 6.1, 40.3]\nvelocity = [0.0, 0.0, 0.1]");
  for (const char* z : {"120", "200", "280"})
    c.bodies += body_of("sphere", 200, std::string("motion = \"fixed\"\nposition = [6, 6, ") + z + "]");
  const std::uint64_t alone = tests::alone([&] {
    Simulation s = c.start(MPI_COMM_SELF);
    s.run(66);
    return s.hash();
  });
  Simulation s = c.start(MPI_COMM_WORLD, {"run.device=host"});
  EXPECT_GT(tests::sum_over_ranks(double(regrids(s, 66))), 0);
  EXPECT_EQ(s.hash(), alone);
}

TEST(Regrid, MomentumIsConserved) {
  Simulation s = flying().start(MPI_COMM_WORLD);
  const Balance before = s.balance();
  EXPECT_GT(tests::sum_over_ranks(double(regrids(s, 160))), 3);
  const Balance after = s.balance();
  EXPECT_LT((after.momentum - before.momentum).norm(), 1e-11 * before.momentum_scale);
}

TEST(Regrid, ABodyAtABorderIsNamed) {
  if (tests::rank() != 0) return;
  Simulation s = flying().start(MPI_COMM_SELF);
  s.run(8);
  const std::uint64_t before = s.hash();
  const rigid::Pose far{{40, 40, 40}, rigid::Quat::Identity()};
  EXPECT_TEXT(tests::error_of<std::invalid_argument>([&] { s.set_pose(1, far); }),
              "position is [40, 40, 40]: there are coarser cells within ");
  EXPECT_EQ(s.hash(), before);
  s.bodies().set_pose(s.bodies().row_of(1), far);  // a program that asks nobody
  s.scene().exchange->relocate(s.bodies());
  const std::string said = tests::error_of<GuardStop>([&] { s.run(25); });
  EXPECT_TEXT(said, "step 32: body 1 ");
  EXPECT_TEXT(said, "raise coarsening.distance (now 7 cells)");
}

}  // namespace
}  // namespace silt::coupler::testing
