// Work is where it was put, all of it.
#include "coupler/balance/work_map.hpp"

#include <gtest/gtest.h>

#include "lbm/equal_cut.hpp"

namespace silt::coupler {
namespace {

using rigid::Vec3;

/// 20 x 16 x 12 cells, periodic along x, walls elsewhere.
WorkMap empty_map() {
  std::array<lbm::SideCondition, 6> sides;
  for (int s = 2; s < 6; ++s) sides[s].kind = lbm::SideKind::bounce;
  return WorkMap(lbm::Domain(lbm::equal_cut({20, 16, 12}, 1), sides, 1));
}

std::int64_t total(const WorkMap& map) {
  std::int64_t sum = 0;
  for (const WorkItem& item : map.items()) sum += item.work;
  return sum;
}

void expect_only_tile(const WorkMap& map, lbm::Int3 lower, lbm::Int3 size) {
  const auto items = map.items();
  ASSERT_EQ(items.size(), 1u);
  EXPECT_EQ(items[0].box.lower, lower);
  EXPECT_EQ(items[0].box.size, size);
}

TEST(WorkMap, APointIsInItsTile) {
  WorkMap map = empty_map();
  map.add(Vec3(17.5, 3, 11.9), 7);
  expect_only_tile(map, {16, 0, 8}, {4, 8, 4});
  map.add(Vec3(-2, -5, 99), 5);  // a period and walls
  expect_only_tile(map, {16, 0, 8}, {4, 8, 4});
  EXPECT_EQ(total(map), 12);
}

TEST(WorkMap, ABoxIsSpreadOut) {
  WorkMap map = empty_map();
  map.add(rigid::BoundingBox{{-4, 0, 0}, {4, 16, 8}}, 1001);
  EXPECT_EQ(total(map), 1001);
  const auto items = map.items();
  ASSERT_EQ(items.size(), 4u);  // two tiles along x, through the period, and two along y
  for (const WorkItem& item : items) EXPECT_NEAR(double(item.work), 250, 16);
}

TEST(WorkMap, ALargeBoxIsNotWalkedCellByCell) {
  WorkMap map(lbm::Domain(lbm::equal_cut({10000, 10000, 10000}, 1), {}, 1));
  map.add(rigid::BoundingBox{{0, 0, 0}, {10000, 10000, 10000}}, 1'000'000'000'000);
  EXPECT_EQ(total(map), 1'000'000'000'000);
  const auto items = map.items();
  EXPECT_LE(items.size(), 40000u);
  std::int64_t lower_half = 0;
  for (const WorkItem& item : items) lower_half += item.box.lower.z < 5000 ? item.work : 0;
  EXPECT_NEAR(double(lower_half), 5e11, 1e9);
}

}  // namespace
}  // namespace silt::coupler
