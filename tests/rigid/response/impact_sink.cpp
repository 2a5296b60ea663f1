// Which impacts a resolver reports, and with what impulse.
#include <gtest/gtest.h>

#include "tests/rigid/scene.hpp"

namespace silt::rigid::testing {
namespace {

struct Listener final : ImpactSink {
  mutable std::vector<Impact> heard;
  Vec3 operator()(BodySet&, const Impact& impact) const override {
    heard.push_back(impact);
    return 0.5 * impact.impulse * impact.normal;
  }
};

TEST(ImpactSink, HearsOfACollisionOnce) {
  const double masses[] = {1, 3}, speed = 1.5, e = 0.6;
  const auto listener = std::make_shared<Listener>();
  Scene s(e, 0);
  s.settings.impacts = listener;
  const int ball = s.shape(Sphere{0.5});
  const BodyId a = s.add(ball, {10, 10, 10}, {speed, 0, 0}, Vec3::Zero(), masses[0]);
  const BodyId b = s.add(ball, {11.2, 10, 10}, Vec3::Zero(), Vec3::Zero(), masses[1]);
  s.start();
  s.run(500);
  ASSERT_EQ(listener->heard.size(), 1u);
  const Impact& impact = listener->heard[0];
  EXPECT_EQ(impact.row_a, s.row(a));
  EXPECT_EQ(impact.row_b, s.row(b));
  EXPECT_EQ(impact.normal, Vec3(1, 0, 0));
  EXPECT_NEAR(impact.impulse, (1 + e) * speed / (1 / masses[0] + 1 / masses[1]), 1e-13);
  EXPECT_NEAR(impact.impulse, masses[1] * s.v(b)[0], 1e-13);
}

// Each of the corners is told of with its share.
TEST(ImpactSink, HearsOfAFlatLandingAsOfWhatItChanged) {
  const double speed = 1.5, e = 0.6;
  const auto listener = std::make_shared<Listener>();
  Scene s(e, 0);
  s.settings.impacts = listener;
  const BodyId box = s.add(s.shape(Box{{0.5, 0.5, 0.5}}), {10, 10, 0.7}, {0, 0, -speed});
  s.floor();
  s.start();
  Vec3 on_floor = Vec3::Zero();  // by the listener's word
  for (int i = 0; i < 500; ++i) {
    s.run(1);
    for (const OtherWallImpulse& other : s.step->other_wall_impulses()) on_floor += other.impulse;
  }
  double sum = 0;
  for (const Impact& impact : listener->heard) sum += impact.impulse;
  EXPECT_GT(listener->heard.size(), 1u);
  EXPECT_NEAR(s.v(box)[2], e * speed, 1e-9);
  EXPECT_NEAR(sum, s.bodies.mass[s.row(box)] * (1 + e) * speed, 1e-9);
  EXPECT_LT((on_floor - Vec3(0, 0, -0.5 * sum)).norm(), 1e-12);
}

// A load that rests on a struck contact is no part of the impact.
TEST(ImpactSink, HearsOfNoLoadAtRest) {
  const auto listener = std::make_shared<Listener>();
  Scene s(0.5, 0.3);
  s.settings.impacts = listener;
  s.world.gravity = {0, 0, -9.81};
  const BodyId box = s.add(s.shape(Box{{0.5, 0.5, 0.5}}), {10, 10, 0.5});
  s.floor();
  s.start();
  s.run(1000);
  double sum = 0;
  for (const Impact& impact : listener->heard) {
    EXPECT_GT(impact.impulse, 0);
    sum += impact.impulse;
  }
  EXPECT_LT(sum, 1e-9 * s.bodies.mass[s.row(box)] * 9.81);
}

}  // namespace
}  // namespace silt::rigid::testing
