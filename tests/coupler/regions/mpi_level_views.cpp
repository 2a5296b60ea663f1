// Every rank sees the levels that one rank alone finds, of its own part and of those beside it.
#include "coupler/regions/level_views.hpp"

#include <gtest/gtest.h>

#include "parallel/collectives.hpp"
#include "tests/coupler/regions/level_scene.hpp"
#include "tests/errors.hpp"
#include "tests/odd_cut.hpp"
#include "tests/world.hpp"

namespace silt::coupler::testing {
namespace {

using lbm::Int3;
using tests::rank;
using tests::ranks;

class LevelViews : public ::testing::TestWithParam<int> {};

bool touch(const lbm::CellBox& a, const lbm::CellBox& b, const Case& setup) {
  for (int d = 0; d < 3; ++d) {
    const int n = setup.cells[d], a_end = a.lower[d] + a.size[d], b_end = b.lower[d] + b.size[d];
    const bool across =
        setup.periodic(d) && ((a_end == n && b.lower[d] == 0) || (b_end == n && a.lower[d] == 0));
    if (!across && (a_end < b.lower[d] || b_end < a.lower[d])) return false;
  }
  return true;
}

/// Expects what a rank sees of a scene whose domain has these parts.
void expect_levels(const LevelScene& scene, const lbm::CutTree& parts) {
  const lbm::CutTree whole = scene.levels();
  coupler::LevelViews views(scene.setup, entrances_of(scene.setup), parts, scene.world, MPI_COMM_WORLD);
  const lbm::CutTree view = views.view(scene.held_by(rank(), parts));
  const lbm::CellBox mine = parts.leaf(rank()).box;
  for (int k = 0; k < view.leaves(); ++k) {
    const auto [owner, level, place] = view.kinds()[k];
    const lbm::CellBox box = view.leaf(k).box;
    EXPECT_EQ(owner, parts.leaf_at(box.lower).index);
    const bool beside = owner == rank() || std::count(views.beside().begin(), views.beside().end(), owner);
    EXPECT_EQ(level != lbm::LeafKind::far, beside);
    if (beside)
      lbm::for_cells(box.lower, box.lower + box.size, [&](Int3 x) { ASSERT_EQ(level, level_at(whole, x)); });
    else
      EXPECT_FALSE(touch(mine, box, scene.setup));
  }
}

TEST_P(LevelViews, AreThoseOfOneRank) {
  for (const char* boundary : {"\"periodic\"", "\"no-slip\""}) {
    const LevelScene scene(many_bodies(GetParam(), boundary));
    expect_levels(scene, scene.parts(ranks()));
    for (const int seed : {1, 2, 3})
      expect_levels(scene, of_cells(tests::odd_cut(tiles_of(scene.setup), ranks(), 1, seed), scene.setup));
  }
}

/// Ranks number the leaves of a part alike.
TEST_P(LevelViews, BothEndsAgree) {
  const LevelScene scene(many_bodies(GetParam(), "\"periodic\""));
  const lbm::CutTree parts = scene.parts(ranks());
  const lbm::CutTree view =
      coupler::LevelViews(scene.setup, entrances_of(scene.setup), parts, scene.world, MPI_COMM_WORLD)
          .view(scene.held_by(rank(), parts));
  struct Told {
    lbm::LeafKind kind;
    lbm::CellBox box;
  };
  std::vector<Told> mine, known;
  for (int k = 0; k < view.leaves(); ++k) {
    const Told leaf{view.kinds()[k], view.leaf(k).box};
    if (leaf.kind.level != lbm::LeafKind::far) known.push_back(leaf);
    if (leaf.kind.rank == rank()) mine.push_back(leaf);
  }
  const std::vector<Told> all =
      parallel::gathered(MPI_COMM_WORLD, std::span<const Told>(mine), parallel::GatherTo::all_ranks);
  for (const Told& leaf : known)
    EXPECT_EQ(1, std::count_if(all.begin(), all.end(), [&](const Told& t) {
                return t.kind == leaf.kind && t.box.lower == leaf.box.lower && t.box.size == leaf.box.size;
              }));
}

INSTANTIATE_TEST_SUITE_P(Levels, LevelViews, ::testing::Values(1, 2));

TEST(CutForLevels, SaysWhenThereAreTooManyRanks) {
  const LevelScene scene(many_bodies(2, "\"periodic\""));
  EXPECT_EQ(tests::error_of<std::invalid_argument>([&] { scene.parts(1000); }),
            "the domain of 84 x 96 x 80 cells cannot be cut into 1000 parts of at least 16 cells an edge, "
            "four of the coarsest; use fewer ranks, or fewer coarsening.levels");
}

}  // namespace
}  // namespace silt::coupler::testing
