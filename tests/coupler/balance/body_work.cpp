// A contact is the same work whether two bodies remember it or one, and none while it is held.
#include "coupler/balance/body_work.hpp"

#include <gtest/gtest.h>

#include "coupler/case/case.hpp"
#include "lbm/equal_cut.hpp"
#include "tests/coupler/case/case_text.hpp"

namespace silt::coupler {
namespace {

using rigid::Vec3;

struct Body {
  std::vector<rigid::BodyId> partners;  // that it remembers; ids count from 1
  rigid::Motion motion = rigid::Motion::free;
  rigid::Wakefulness wakefulness = rigid::Wakefulness::awake;
  bool held = false;  // all of these
};

/// A body is 150, half a contact 100.
std::int64_t work_of(const std::vector<Body>& all) {
  rigid::BodySet bodies;
  for (const Body& body : all) {
    rigid::BodyRecord record;
    record.id = bodies.size() + 1;
    record.motion = body.motion, record.wakefulness = body.wakefulness;
    bodies.add(record);
    for (const rigid::BodyId partner : body.partners)
      bodies.stored_impulses.back().push_back({partner, {}, 0, Vec3(0, 0, 1), body.held});
  }
  bodies.reindex();
  WorkMap work(lbm::Domain(lbm::equal_cut({16, 16, 16}, 1), {}, 1));
  WorkCosts costs(testing::CaseText{}.read());
  costs.body = 150, costs.impulse = 100;
  add_bodies(bodies, costs, work);
  std::int64_t sum = 0;
  for (const WorkItem& item : work.items()) sum += item.work;
  return sum;
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

TEST(BodyWork, ContactsThatAreHeldAreNone) {
  using enum rigid::Motion;
  using enum rigid::Wakefulness;
  EXPECT_EQ(work_of({{{2}, free, asleep, true}, {{1}, free, asleep, true}}), 2 * 150);
  EXPECT_EQ(work_of({{{rigid::first_wall_id}, free, asleep, true}, {}}), 2 * 150);
  EXPECT_EQ(work_of({{{2}, free, asleep}, {{1}}}), 2 * 150 + 200) << "with one that moves";
}

}  // namespace
}  // namespace silt::coupler
