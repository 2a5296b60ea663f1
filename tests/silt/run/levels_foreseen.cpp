// The estimate of a run whose cells are of several levels.
#include <gtest/gtest.h>

#include "coupler/flow.hpp"
#include "silt/case/case.hpp"
#include "silt/case/case_check.hpp"
#include "silt/case/case_file.hpp"
#include "silt/run/run_estimate.hpp"
#include "tests/errors.hpp"
#include "tests/silt/case/case_text.hpp"

namespace silt::testing {
namespace {

/// A ball near the side where fluid comes in.
CaseText ball_in_a_stream(const std::string& coarsening) {
  CaseText c;
  c.domain = domain_of({128, 96, 96},
                       "{ x = [{ type = \"velocity-inlet\", velocity = [0.02, 0, 0] }, \"pressure-outlet\"], "
                       "y = \"periodic\", z = \"periodic\" }");
  c.rest = coarsening;
  c.bodies = body_of("ball", 1, "position = [16, 48, 48]\nmotion = \"fixed\"");
  return c;
}

RunEstimate foreseen(const Case& setup, int ranks = 1) {
  return estimate_run(setup, {}, ranks);
}

TEST(LevelsForeseen, CellsMemoryAndUpdates) {
  const Case uniform = ball_in_a_stream("").read(),
             coarse = ball_in_a_stream("[coarsening]\nlevels = 2\n").read();
  const RunEstimate all = foreseen(uniform), some = foreseen(coarse), two = foreseen(coarse, 2);
  EXPECT_TRUE(all.cells.empty());
  ASSERT_EQ(some.cells.size(), 3u);
  EXPECT_EQ(some.cells[0], 24 * 24 * 24);  // 4 + 8 on either side of the middle
  EXPECT_EQ(some.cells[0] + 8 * some.cells[1] + 64 * some.cells[2], coarse.volume());
  EXPECT_LT(two.largest_over_mean, 1.2);
  // Faces to level 1, 12 x 12 of its cells each, then those to level 2, of 16 x 16 and 12 x 16: 60, 30 and 15
  // updates a cell across x, y and z; level 1 has a step of two.
  const double at_faces = 2 * 144 * (60 + 30 + 15) + (256 * 60 + 2 * 192 * (30 + 15)) / 2.;
  EXPECT_NEAR(some.cell_updates, some.cells[0] + some.cells[1] / 2 + some.cells[2] / 4 + at_faces, 10);
  const double saved =
      fluid_memory(uniform) * (1 - (some.cells[0] + some.cells[1] + some.cells[2]) / coarse.volume());
  EXPECT_NEAR(all.memory - some.memory, saved, 1);
  const std::string text = estimate_table(coarse, some);
  for (const char* part : {"cells of level 0          13824, 1.2 % of the domain\n", "cells of level 2",
                           "  work of a step", "if every cell were finest, borders included\n"})
    EXPECT_TEXT(text, part);
  EXPECT_TEXT(derived_table(coarse), "of cells 4 times as wide");
}

TEST(LevelsForeseen, ASideWhereCellsChangeTheirWidthIsWarnedOf) {
  const auto warnings = foreseen(ball_in_a_stream("[coarsening]\nlevels = 2\n").read()).doubts;
  EXPECT_EQ(listed(warnings),
            "case.toml:8:2: warning: coarsening: cells of domain.boundary.x[0] are from 2 to 4 finest cells "
            "wide at the start, and the fluid that enters or leaves is disturbed where the width changes: "
            "give coarsening.fine a box along it, or leave more room before it");
  const std::string fine = "[coarsening]\nlevels = 2\nfine = [{ box = [[0, 0, 0], [8, 96, 96]] }]\n";
  EXPECT_TRUE(foreseen(ball_in_a_stream(fine).read()).doubts.empty());
}

}  // namespace
}  // namespace silt::testing
