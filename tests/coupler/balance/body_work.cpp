// A contact is the same work whether two bodies remember it or one.
#include "coupler/balance/body_work.hpp"

#include <gtest/gtest.h>

#include "coupler/case/case.hpp"
#include "lbm/equal_cut.hpp"
#include "tests/coupler/case/case_text.hpp"

namespace silt::coupler {
namespace {

using rigid::Vec3;

std::int64_t work_of(const std::vector<std::vector<rigid::BodyId>>& partners) {
  rigid::BodySet bodies;
  for (std::size_t k = 0; k < partners.size(); ++k) {
    rigid::BodyRecord record;
    record.id = k + 1;
    bodies.add(record);
    for (const rigid::BodyId partner : partners[k])
      bodies.stored_impulses.back().push_back({partner, {}, 0, Vec3(0, 0, 1)});
  }
  bodies.owned = partners.size();
  WorkMap work(lbm::Domain(lbm::equal_cut({16, 16, 16}, 1), {}, 1));
  WorkCosts costs(testing::CaseText{}.read());
  costs.body = 150, costs.impulse = 100;
  add_bodies(bodies, costs, work);
  std::int64_t sum = 0;
  for (const WorkItem& item : work.items()) sum += item.work;
  return sum;
}

TEST(BodyWork, AContactCountsAlikeWhereverItIs) {
  const std::int64_t two_bodies = work_of({{}, {}});
  EXPECT_EQ(two_bodies, 2 * 150);
  EXPECT_EQ(work_of({{2}, {1}}) - two_bodies, 200);
  EXPECT_EQ(work_of({{rigid::first_wall_id}, {}}) - two_bodies, 200);
  EXPECT_EQ(work_of({{rigid::first_tube_id + 1}, {}}) - two_bodies, 200);
}

}  // namespace
}  // namespace silt::coupler
