// Levels of cells that follow bodies: the same bits on any ranks, however they are cut, and nothing made or
// lost where cells are refined and coarsened.
#include <gtest/gtest.h>

#include "coupler/case/fluid_spec.hpp"
#include "coupler/guard.hpp"
#include "coupler/simulation.hpp"
#include "tests/coupler/case/case_text.hpp"
#include "tests/world.hpp"

namespace silt::coupler::testing {
namespace {

/// Spheres that fly past each other in a periodic box of cells of three levels.
CaseText flying(const std::string& run = "") {
  CaseText c;
  c.domain = domain_of({96, 64, 64});
  c.fluid += "precision = \"double\"\n";
  c.rest = "[coupling]\nforce = \"exact\"\nmass_correction = false\n[coarsening]\nlevels = 2\ndistance = 7\n";
  c.shapes = sphere_of("sphere", 6.5);
  c.bodies = body_of("sphere", 200, "position = [5.2, 16.1, 7.3]\nvelocity = [0.08, 0.03, 0.0]") +
             body_of("sphere", 100, "position = [67.4, 26.9, 17.9]\nvelocity = [-0.06, 0.0, 0.05]");
  c.run = "[run]\nsteps = 640\n" + run;
  return c;
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
  EXPECT_EQ(alone, hash_of(MPI_COMM_WORLD, "balance = { every = 16 }\n"));
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
  s.set_pose(1, {{40, 40, 40}, rigid::Quat::Identity()});
  try {
    s.run(9);
    ADD_FAILURE() << "its links read coarser cells";
  } catch (const GuardStop& stop) {
    const std::string said = stop.what();
    EXPECT_NE(said.find("step 16: body 1 "), std::string::npos) << said;
    EXPECT_NE(said.find("raise coarsening.distance (now 7 cells)"), std::string::npos) << said;
  }
}

}  // namespace
}  // namespace silt::coupler::testing
