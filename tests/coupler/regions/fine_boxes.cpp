// Cells are finest near surfaces, coarser elsewhere, and neighbours differ by a level at most.
#include "coupler/regions/level_views.hpp"

#include <gtest/gtest.h>

#include "tests/coupler/regions/level_scene.hpp"

namespace silt::coupler::testing {
namespace {

using lbm::Int3;
using rigid::Vec3;

/// Calls visit(cell, its neighbour) for every cell and those beside it, across periods as well.
template <class Visit>
void for_neighbours(const Case& setup, Visit&& visit) {
  const Int3 n{setup.cells[0], setup.cells[1], setup.cells[2]};
  lbm::for_cells({}, n, [&](Int3 x) {
    for (int i = 1; i < lbm::D3Q19::directions; ++i) {
      Int3 y = x + lbm::D3Q19::c[i];
      bool inside = true;
      for (int d = 0; d < 3; ++d) {
        if (setup.periodic(d)) y[d] = (y[d] + n[d]) % n[d];
        inside = inside && y[d] >= 0 && y[d] < n[d];
      }
      if (inside) visit(x, y);
    }
    Int3 corner = x + Int3{1, 1, 1};
    for (int d = 0; d < 3; ++d)
      corner[d] = setup.periodic(d) ? corner[d] % n[d] : std::min(corner[d], n[d] - 1);
    visit(x, corner);
  });
}

/// The levels of all cells, x fastest.
struct LevelField {
  Int3 n;
  std::vector<int> levels;
  explicit LevelField(const lbm::CutTree& tree) : n(tree.cells()), levels(std::size_t(n.x) * n.y * n.z) {
    for (int k = 0; k < tree.leaves(); ++k) {
      const lbm::CellBox box = tree.leaf(k).box;
      lbm::for_cells(box.lower, box.lower + box.size, [&](Int3 x) { at(x) = tree.kinds()[k].level; });
    }
  }
  int& at(Int3 x) { return levels[(std::size_t(x.z) * n.y + x.y) * n.x + x.x]; }
  std::int64_t count(int level) const { return std::count(levels.begin(), levels.end(), level); }
};

void expect_gentle(const Case& setup, LevelField& field) {
  int steepest = 0;
  for_neighbours(setup,
                 [&](Int3 x, Int3 y) { steepest = std::max(steepest, std::abs(field.at(x) - field.at(y))); });
  EXPECT_EQ(steepest, 1);
}

/// Leaves are two cells of their own thick at least.
void expect_thick(const lbm::CutTree& tree) {
  for (int k = 0; k < tree.leaves(); ++k)
    for (int d = 0; d < 3; ++d) EXPECT_GE(tree.leaf(k).box.size[d], 2 << tree.kinds()[k].level);
}

TEST(FineBoxes, BodiesAreAmongFinestCells) {
  for (const char* boundary : {"\"periodic\"", "\"no-slip\""})
    for (const int levels : {1, 2}) {
      SCOPED_TRACE(::testing::Message() << levels << " levels, " << boundary);
      const LevelScene scene(many_bodies(levels, boundary));
      const lbm::CutTree tree = scene.levels();
      LevelField field(tree);
      expect_gentle(scene.setup, field);
      expect_thick(tree);
      const rigid::Extent extent = extent_of(scene.setup);
      lbm::for_cells({}, tree.cells(), [&](Int3 x) {
        for (std::size_t row = 0; row < scene.bodies.owned; ++row) {
          const rigid::Pose pose = scene.bodies.pose(row);
          const Vec3 arm = nearest_image(Vec3(x.x + 0.5, x.y + 0.5, x.z + 0.5) - pose.position, extent);
          const double distance = rigid::signed_distance(scene.world.shapes[scene.bodies.shape[row]],
                                                         pose.orientation.conjugate() * arm);
          if (distance < 6) {
            EXPECT_EQ(field.at(x), 0) << x.x << ' ' << x.y << ' ' << x.z;
          }
        }
      });
      EXPECT_GT(field.count(levels), 0);
      EXPECT_LT(field.count(0), 5 * 24 * 24 * 24);
    }
}

TEST(FineBoxes, ACaseNamesBoxes) {
  CaseText c;
  c.domain =
      domain_of({64, 64, 96}, "{ x = \"periodic\", y = \"periodic\", z = [\"no-slip\", \"no-slip\"] }");
  c.shapes = c.bodies = "";
  c.rest =
      "[coarsening]\nlevels = 2\ndistance = 7\n"
      "fine = [{ box = [[0, 0, 89], [64, 64, 96]] }, { box = [[30, 30, 5], [33, 33, 17]], level = 1 }]\n";
  const LevelScene scene(c.text());
  LevelField field(scene.levels());
  expect_gentle(scene.setup, field);
  EXPECT_EQ(field.count(0), 64 * 64 * 8);
  EXPECT_EQ(field.at({1, 2, 88}), 0);
  EXPECT_EQ(field.at({1, 2, 87}), 1);
  EXPECT_EQ(field.at({1, 2, 71}), 2);
  EXPECT_EQ(field.at({30, 30, 5}), 1);
  EXPECT_EQ(field.count(1), 64 * 64 * 16 + 16 * 16 * 24);
}

TEST(FineBoxes, TheLastTileOfAnAxisIsLongerWhereHalfATileIsOver) {
  for (const char* boundary : {"\"periodic\"", "\"no-slip\""}) {
    CaseText c;
    c.domain = domain_of({84, 32, 32}, boundary);
    c.shapes = c.bodies = "";
    c.rest = "[coarsening]\nlevels = 2\nfine = [{ box = [[81, 8, 8], [83, 12, 12]], level = 1 }]\n";
    LevelField field(LevelScene(c.text()).levels());
    for (const int x : {72, 83}) EXPECT_EQ(field.at({x, 8, 8}), 1) << x;
    for (const int x : {71, 0}) EXPECT_EQ(field.at({x, 8, 8}), 2) << x;
  }
}

TEST(FineBoxes, CurvedWallsAreAmongFinestCells) {
  CaseText c;
  c.domain = domain_of(
      {96, 96, 16}, "{ x = [\"no-slip\", \"no-slip\"], y = [\"no-slip\", \"no-slip\"], z = \"periodic\" }");
  c.shapes = c.bodies = "";
  c.rest =
      "[coarsening]\nlevels = 1\ndistance = 6\n[[walls]]\nname = \"pipe\"\ntype = \"tube\"\naxis = "
      "\"z\"\nradius = 44\npoint = [48, 48, 0]\n";
  const LevelScene scene(c.text());
  const lbm::CutTree tree = scene.levels();
  LevelField field(tree);
  std::int64_t near = 0;
  lbm::for_cells({}, tree.cells(), [&](Int3 x) {
    const double radius = std::sqrt(std::pow(x.x + 0.5 - 48, 2) + std::pow(x.y + 0.5 - 48, 2));
    near += std::abs(radius - 44) < 6;
    if (std::abs(radius - 44) < 6) {
      EXPECT_EQ(field.at(x), 0);
    } else if (radius < 44 - 6 - 2 * 4 * std::sqrt(3.)) {
      EXPECT_EQ(field.at(x), 1);
    }
  });
  EXPECT_LT(field.count(0), 2 * near);
  EXPECT_LT(tree.leaves(), 200);
}

}  // namespace
}  // namespace silt::coupler::testing
