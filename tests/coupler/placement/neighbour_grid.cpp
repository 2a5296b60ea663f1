// The grid of boxes finds what may touch, in any periodic image, whatever the sizes.
#include "coupler/placement/neighbour_grid.hpp"

#include <gtest/gtest.h>

#include <random>
#include <set>

namespace silt::coupler::testing {
namespace {

using rigid::BoundingBox;
using rigid::Vec3;

/// Whether two intervals meet, in an image along a periodic axis.
bool meet(double low_a, double high_a, double low_b, double high_b, double length, bool periodic) {
  for (int k = periodic ? -2 : 0; k <= (periodic ? 2 : 0); ++k)
    if (low_a + k * length <= high_b && low_b <= high_a + k * length) return true;
  return false;
}

bool touch(const BoundingBox& a, const BoundingBox& b, const rigid::Extent& extent) {
  for (int d = 0; d < 3; ++d)
    if (!meet(a.lower[d], a.upper[d], b.lower[d], b.upper[d], extent.size[d], extent.periodic[d]))
      return false;
  return true;
}

TEST(NeighbourGrid, FindsAllThatTouch) {
  const rigid::Extent extent{Vec3(40, 13, 25), {true, false, true}};
  std::mt19937 engine(3);
  std::uniform_real_distribution<double> place(0, 1);
  for (const double edge : {0.7, 3.0, 50.0}) {
    std::vector<BoundingBox> boxes;
    NeighbourGrid grid(extent, edge);
    for (int i = 0; i < 300; ++i) {
      Vec3 centre, half;
      for (int d = 0; d < 3; ++d) centre[d] = extent.size[d] * (1.2 * place(engine) - 0.1);
      const double size = i % 50 == 0 ? 12 : 1;  // a few in very many cells
      for (int d = 0; d < 3; ++d) half[d] = size * place(engine);
      boxes.push_back(BoundingBox::around(centre, half));
      std::set<int> found;
      grid.visit(boxes.back(), [&](int k) { return found.insert(k), true; });
      for (int k = 0; k < i; ++k)
        EXPECT_TRUE(found.count(k) || !touch(boxes[k], boxes[i], extent)) << k << " and " << i;
      grid.insert(i, boxes.back());
    }
  }
}

TEST(NeighbourGrid, LeavesOutWhatIsFar) {
  const rigid::Extent extent{Vec3(1000, 1000, 1000), {false, false, false}};
  NeighbourGrid grid(extent, 2);
  for (int i = 0; i < 1000; ++i) grid.insert(i, BoundingBox::around(Vec3(i, i, i), Vec3::Constant(0.5)));
  int looked_at = 0;
  grid.visit(BoundingBox::around(Vec3(500, 500, 500), Vec3::Constant(0.5)),
             [&](int) { return ++looked_at, true; });
  EXPECT_LE(looked_at, 12);
}

}  // namespace
}  // namespace silt::coupler::testing
