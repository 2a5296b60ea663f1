// What a blow gives to the mass that moves with a body.
#include <gtest/gtest.h>

#include "tests/rigid/scene.hpp"

namespace silt::rigid::testing {
namespace {

constexpr double entrained = 0.8;

/// A body that displaces so much mass.
void let_displace(Scene& s, BodyId id, double mass) {
  s.bodies.weight_factor[s.row(id)] = 1 - mass / s.bodies.mass[s.row(id)];
}
const Vec3& pending(const Scene& s, BodyId id) {
  return s.bodies.pending_blow[s.row(id)];
}

TEST(Blows, TurnRoundWhatMovesWithTheBodies) {
  const double masses[] = {1, 2}, displaced[] = {0.9, 0.4}, speed = 1.5, e = 0.6;
  Scene s(e, 0);
  s.settings.entrained = entrained;
  const int ball = s.shape(Sphere{0.5});
  const BodyId a = s.add(ball, {10, 10, 10}, {speed, 0, 0}, Vec3::Zero(), masses[0]);
  const BodyId b = s.add(ball, {11.2, 10, 10}, Vec3::Zero(), Vec3::Zero(), masses[1]);
  let_displace(s, a, displaced[0]), let_displace(s, b, displaced[1]);
  s.start();
  s.run(500);
  // the bodies alone part as ever; with all that the blow gives, so do bodies and entrained masses together
  EXPECT_NEAR(s.v(b)[0] - s.v(a)[0], e * speed, 1e-14);
  EXPECT_EQ(pending(s, a), Vec3(-pending(s, b)));
  const double impulse = masses[1] * s.v(b)[0] + pending(s, b)[0];
  const auto together = [&](int k) { return masses[k] + entrained * displaced[k]; };
  EXPECT_NEAR(impulse * (1 / together(0) + 1 / together(1)), (1 + e) * speed, 1e-14);
}

TEST(Blows, OfAWall) {
  Scene s(0.5, 0.3);
  s.settings.entrained = entrained;
  const BodyId ball = s.add(s.shape(Sphere{0.5}), {10, 10, 1}, {0.4, 0, -2});
  let_displace(s, ball, 0.25);
  s.floor();
  s.start();
  s.run(500);
  EXPECT_NEAR(pending(s, ball)[2], entrained * 0.25 * 1.5 * 2, 1e-14);
  EXPECT_EQ(pending(s, ball)[0], 0);
}

// Each of the four corners has to turn round, none of them gets the blow of a whole box.
TEST(Blows, OfAFaceThatLandsFlat) {
  constexpr double e = 0.5, speed = 2, displaced = 0.25;
  Scene s(e, 0.3);
  s.settings.entrained = entrained;
  const BodyId box = s.add(s.shape(Box{{1, 1, 1}}), {10, 10, 0.7}, {0, 0, -speed});
  let_displace(s, box, displaced);
  s.floor();
  s.start();
  s.run(300);
  EXPECT_NEAR(s.v(box)[2], e * speed, 1e-12);
  EXPECT_NEAR(pending(s, box)[2], entrained * displaced * (1 + e) * speed, 1e-12);
}

TEST(Blows, RestIsNone) {
  Scene s(0.5, 0.3);
  s.settings.entrained = entrained;
  s.world.gravity = {0, 0, -9.81};
  const int box = s.shape(Box{{1, 1, 1}});
  const BodyId below = s.add(box, {10, 10, 0.5}), above = s.add(box, {10, 10, 1.5});
  for (const BodyId id : {below, above}) let_displace(s, id, 0.5);
  s.floor();
  s.start();
  s.run(1000);
  const double weight = 2 * 9.81;  // its impulse on the floor
  EXPECT_LT(pending(s, below).norm() + pending(s, above).norm(), 1e-9 * weight);
}

TEST(Blows, NothingDisplacedNothingPending) {
  Scene s(1, 0);
  s.settings.entrained = entrained;
  const BodyId ball = s.add(s.shape(Sphere{0.5}), {10, 10, 1}, {0, 0, -2});
  s.floor();
  s.start();
  s.run(500);
  EXPECT_GT(s.v(ball)[2], 0);
  EXPECT_EQ(pending(s, ball), Vec3::Zero());
}

}  // namespace
}  // namespace silt::rigid::testing
