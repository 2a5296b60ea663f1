// Maps of work: a point's and a box's tiles, and what cells and contacts of bodies count for.
#include <gtest/gtest.h>

#include "coupler/balance/body_work.hpp"
#include "lbm/blocks/equal_cut.hpp"
#include "silt/case/case.hpp"
#include "tests/silt/case/case_text.hpp"

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
  ASSERT_EQ(items.size(),
            4u);  // two tiles along x, through the period, and two along y
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

struct Body {
  std::vector<rigid::BodyId> partners;  // that it remembers; ids count from 1
  rigid::Motion motion = rigid::Motion::free;
};

/// A body is 150, half a contact 100.
std::int64_t work_of(const std::vector<Body>& all) {
  rigid::BodySet bodies;
  for (const Body& body : all) {
    rigid::BodyRecord record;
    record.id = bodies.size() + 1;
    record.motion = body.motion;
    bodies.add(record);
    for (const rigid::BodyId partner : body.partners)
      bodies.stored_impulses.back().push_back({partner, {}, 0, Vec3(0, 0, 1)});
  }
  bodies.reindex();
  WorkMap work(lbm::Domain(lbm::equal_cut({16, 16, 16}, 1), {}, 1));
  WorkCosts costs(testing::CaseText{}.read(), 1);
  costs.body = 150, costs.impulse = 100;
  add_bodies(bodies, costs, work);
  std::int64_t sum = 0;
  for (const WorkItem& item : work.items()) sum += item.work;
  return sum;
}

/// As much as it takes (measurements.md, "Heat").
TEST(CellWork, WarmCellsCountMore) {
  for (const char* precision : {"single", "double"}) {
    const std::string stored = std::string("fluid.precision=") + precision;
    const WorkCosts cold(testing::CaseText{}.read({stored}), 1),
        warm(testing::CaseText{}.read({stored, "heat.prandtl=1"}), 1);
    EXPECT_EQ(10 * warm.cell, 16 * cold.cell) << precision;
    EXPECT_EQ(warm.link, cold.link);
  }
}

TEST(BodyWork, AContactCountsAlikeWhereverItIs) {
  using enum rigid::Motion;
  EXPECT_EQ(work_of({{}, {}}), 2 * 150);
  EXPECT_EQ(work_of({{{2}}, {{1}}}), 2 * 150 + 200);
  EXPECT_EQ(work_of({{{rigid::first_wall_id}}, {}}), 2 * 150 + 200);
  EXPECT_EQ(work_of({{{rigid::first_tube_id + 1}}, {}}), 2 * 150 + 200);
  EXPECT_EQ(work_of({{{2}}, {{}, fixed}}), 150 + 200);
  EXPECT_EQ(work_of({{{2}}, {{}, prescribed}}), 2 * 150 + 200);
  EXPECT_EQ(work_of({{{7}}}), 150 + 100) << "whose other half another rank has";
}

}  // namespace
}  // namespace silt::coupler
