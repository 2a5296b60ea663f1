// Every cell is in a leaf of its level, and there are few leaves.
#include "lbm/level_cut.hpp"

#include <gtest/gtest.h>

#include <random>

namespace silt::lbm {
namespace {

using Boxes = std::vector<LevelBox>;

/// Boxes on a grid of so many cells, of every level below `levels`; some stick out of the part.
Boxes random_boxes(int count, int grid, int levels, const CellBox& part, int least, int most) {
  std::mt19937 random(5);
  Boxes boxes;
  for (int k = 0; k < count; ++k) {
    LevelBox& b = boxes.emplace_back();
    b.level = k % levels;
    for (int d = 0; d < 3; ++d) {
      b.box.size[d] = grid * std::uniform_int_distribution(least, most)(random);
      b.box.lower[d] = part.lower[d] + grid * std::uniform_int_distribution(-2, part.size[d] / grid)(random);
    }
  }
  return boxes;
}

int leaves_of(const CellBox& part, const Boxes& boxes, int coarsest) {
  return int(level_cut(part, boxes, coarsest).levels.size());
}

/// The tree of a part at the origin.
CutTree tree_of(const CellBox& part, const LevelCut& cut) {
  std::vector<LeafKind> kinds;
  for (const int level : cut.levels) kinds.push_back({0, level});
  return {part.size, cut.nodes, kinds};
}

TEST(LevelCut, EveryCellHasTheLeastLevelOfItsBoxes) {
  const CellBox part{{}, {48, 40, 32}};
  for (int count = 0; count < 20; ++count) {
    SCOPED_TRACE(count);
    const Boxes boxes = random_boxes(count, 4, 2, part, 2, 8);
    const LevelCut cut = level_cut(part, boxes, 2);
    const CutTree tree = tree_of(part, cut);
    for_cells({}, part.size, [&](Int3 x) {
      int level = 2;
      for (const LevelBox& b : boxes)
        if (b.box.contains(x)) level = std::min(level, b.level);
      ASSERT_EQ(cut.levels[tree.leaf_at(x).index], level);
    });
  }
}

TEST(LevelCut, OfBoxesAlikeTheFinerCounts) {
  const CellBox part{{}, {32, 32, 32}};
  EXPECT_EQ(level_cut(part, Boxes{{part, 0}, {part, 1}}, 2).levels, std::vector<std::int32_t>{0});
}

TEST(LevelCut, PartsAreCutAsTheyLieInTheDomain) {
  const CellBox part{{64, 32, 16}, {32, 32, 32}};
  const Boxes boxes = {{{{72, 40, 24}, {8, 8, 8}}, 0}};
  const LevelCut cut = level_cut(part, boxes, 1);
  EXPECT_EQ(cut.levels.size(), 7u);
  for (const Cut& plane : cut.nodes) {
    EXPECT_GT(plane.position, part.lower[plane.axis]);
    EXPECT_LT(plane.position, part.lower[plane.axis] + part.size[plane.axis]);
  }
}

TEST(LevelCut, AViewHasTheLeavesOfPartsThatAreTold) {
  const CutTree parts({64, 32, 32}, {{0, 32, 2}, {1, 16, 1}});
  const LevelCut cut = level_cut(parts.leaf(1).box, Boxes{{{{8, 16, 8}, {8, 8, 8}}, 0}}, 1);
  const CutTree view = view_of(parts, {{1, cut}});
  const auto leaves = int(cut.levels.size());
  EXPECT_EQ(view.leaves(), leaves + 2);
  for (int k = 0; k < view.leaves(); ++k) {
    const int part = k == 0 ? 0 : k <= leaves ? 1 : 2;
    EXPECT_EQ(view.kinds()[k].rank, part);
    EXPECT_EQ(view.kinds()[k].level, part == 1 ? cut.levels[k - 1] : LeafKind::far);
    EXPECT_EQ(parts.leaf_at(view.leaf(k).box.lower).index, part);
  }
  EXPECT_EQ(view.kinds()[view.leaf_at({8, 16, 8}).index].level, 0);
}

TEST(LevelCut, LeavesAreFew) {
  const CellBox part{{}, {256, 256, 256}};
  const LevelBox inner{{{104, 104, 104}, {32, 32, 32}}, 0}, outer{{{72, 80, 88}, {96, 88, 80}}, 1};
  EXPECT_EQ(leaves_of(part, {}, 2), 1);
  EXPECT_EQ(leaves_of(part, {inner}, 1), 7);
  EXPECT_EQ(leaves_of(part, {outer, inner}, 2), 13);
  EXPECT_EQ(leaves_of(part, {inner, outer, {{{112, 112, 112}, {8, 8, 8}}, 1}}, 2), 13);  // a hidden one
  EXPECT_EQ(leaves_of(part, {{{{-8, -8, -8}, {300, 300, 300}}, 0}}, 1), 1);
  const LevelBox one_half{{{0, 0, 0}, {256, 128, 256}}, 0}, other_half{{{0, 128, 0}, {256, 128, 256}}, 0};
  EXPECT_EQ(leaves_of(part, {one_half, other_half}, 1), 1);
  for (const int count : {50, 200})
    EXPECT_LE(leaves_of(part, random_boxes(count, 4, 1, part, 7, 7), 1), 10 * count) << count;
}

}  // namespace
}  // namespace silt::lbm
