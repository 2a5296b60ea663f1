// How bodies pass on what impacts gave to the fluid around them.
#include <gtest/gtest.h>

#include <cmath>

#include "coupler/exchange/coupling_state.hpp"
#include "coupler/forces/entrained_fluid.hpp"

namespace silt::coupler {
namespace {

using rigid::Vec3;

constexpr double radius = 6, density = 2.5;  // cells; over that of the fluid
const Vec3 impact(0.3, -0.1, 2);             // impulse, lattice units

/// Bodies of the volume of a sphere with something pending; the second one is a copy.
rigid::BodySet struck(const Vec3& pending) {
  rigid::BodySet bodies;
  for (rigid::BodyId id = 1; id <= 2; ++id) {
    rigid::BodyRecord r;
    r.id = id;
    r.mass = density * 4 * M_PI / 3 * radius * radius * radius;
    bodies.add(r);
  }
  bodies.owned = 1, bodies.copies = 1;
  for (std::size_t row = 0; row < 2; ++row) {
    bodies.weight_in_fluid[row] = 1 - 1 / density;
    pending_impact(bodies, row) = pending;
  }
  return bodies;
}

// In the time in which sound goes a radius far, all but 1/e is passed on.
TEST(EntrainedFluid, FollowsWithTheSpeedOfSound) {
  rigid::BodySet bodies = struck(impact);
  for (int t = 1; t <= 60; ++t) {
    give_pending_impacts(bodies);
    const double left = std::exp(-t / std::sqrt(3.0) / radius);
    EXPECT_LT((pending_impact(bodies, 0) - left * impact).norm(), 1e-14) << t;
    EXPECT_LT((bodies.force[0].value() - (1 - left) * impact).norm(), 1e-13) << t;
  }
}

TEST(EntrainedFluid, IsPassedOnWholeInTheEnd) {
  rigid::BodySet bodies = struck(impact);
  for (int t = 0; t < 400; ++t) give_pending_impacts(bodies);
  EXPECT_EQ(pending_impact(bodies, 0), Vec3::Zero());
  EXPECT_LT((bodies.force[0].value() - impact).norm(), 1e-13);
}

TEST(EntrainedFluid, OfCopiesIsLeftToTheirOwners) {
  rigid::BodySet bodies = struck(impact);
  give_pending_impacts(bodies);
  EXPECT_EQ(pending_impact(bodies, 1), impact);
  EXPECT_EQ(bodies.force[1].value(), Vec3::Zero());
}

}  // namespace
}  // namespace silt::coupler
