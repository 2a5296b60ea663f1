// What every contact resolver keeps: the collision of two balls, and a box at rest.
#include <gtest/gtest.h>

#include "tests/rigid/scene.hpp"

namespace silt::rigid::testing {
namespace {

// Newton's restitution and momentum of a central collision; without a correction of overlaps, which ffd's
// velocities take part in.
TEST(EveryResolver, CollidesTwoBalls) {
  const double speed = 1.5, e = 0.6, masses[] = {1, 2};
  for (const ResolverModel& model : resolver_models()) {
    const std::string_view name = model.name;
    Scene s(e, 0);
    s.settings.correction = 0;
    const int ball = s.shape(Sphere{0.5});
    const BodyId a = s.add(ball, {10, 10, 10}, {speed, 0, 0}, Vec3::Zero(), masses[0]);
    const BodyId b = s.add(ball, {11.2, 10, 10}, Vec3::Zero(), Vec3::Zero(), masses[1]);
    s.start(name);
    s.run(500);
    EXPECT_NEAR(s.v(b)[0] - s.v(a)[0], e * speed, 1e-13) << name;
    EXPECT_NEAR(s.momentum()[0], masses[0] * speed, 1e-13) << name;
  }
}

TEST(EveryResolver, HoldsABoxAtRest) {
  for (const ResolverModel& model : resolver_models()) {
    const std::string_view name = model.name;
    Scene s(0.3, 0.5);
    s.world.gravity = {0, 0, -9.81};
    const BodyId box = s.add(s.shape(Box{{0.5, 0.5, 0.5}}), {10, 10, 0.5});
    s.floor();
    s.start(name);
    s.run(1000);
    const Vec3 moved = s.bodies.position[s.row(box)] - Vec3(10, 10, 0.5);
    EXPECT_LT(moved.norm(), 1e-4) << name;
    EXPECT_LT(s.v(box).norm(), 9.81 * 1e-3) << name;  // a step's kick: ffd takes it back in the next step
  }
}

TEST(EveryResolver, UnknownNamesAreRefusedWithTheKnownOnes) {
  try {
    make_resolver("sfdf", {});
    FAIL();
  } catch (const std::invalid_argument& error) {
    for (const ResolverModel& model : resolver_models())
      EXPECT_NE(std::string_view(error.what()).find(model.name), std::string_view::npos);
  }
}

}  // namespace
}  // namespace silt::rigid::testing
