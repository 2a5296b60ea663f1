// Bodies with locked axes: what they do not do, and what they do all the same, against closed forms.
#include <gtest/gtest.h>

#include <cmath>

#include "rigid/math/types.hpp"
#include "tests/rigid/scene.hpp"

namespace silt::rigid::testing {
namespace {

constexpr LockedAxes place = 7;  // x, y and z

Scene with_locked(LockedAxes locked, double restitution, double friction) {
  Scene s(restitution, friction);
  s.bodies.locked_of_kind = {locked, 0};
  return s;
}

/// The body of kind 1 has no locked axis.
BodyId add_unlocked(Scene& s, int shape, const Vec3& x, const Vec3& v, double mass = 1) {
  const BodyId id = s.add(shape, x, v, Vec3::Zero(), mass);
  s.bodies.kind[s.row(id)] = 1;
  return id;
}

TEST(LockedAxes, WhatMeetsThemBouncesAsFromAWall) {
  constexpr double e = 0.6;
  Scene s = with_locked(locked_along(0), e, 0);
  const int ball = s.shape(Sphere{0.1});
  s.add(ball, Vec3(50, 50, 50), Vec3(0, 0.3, 0));
  add_unlocked(s, ball, Vec3(49.7, 50.015, 50),
               Vec3(1, 0.3, 0));  // 0.075 off the line, as they fly on together
  s.start();
  s.run(300);
  const double sine = 0.015 / 0.2, cosine2 = 1 - sine * sine;
  EXPECT_EQ(s.v(0)[0], 0);
  EXPECT_EQ(s.x(0)[0], 50);
  // along the normal n = (cos, -sin): the compliance of the pair is 1 + sin^2
  const double p = (1 + e) * std::sqrt(cosine2) / (1 + sine * sine);
  EXPECT_NEAR(s.v(1)[0], 1 - p * std::sqrt(cosine2), 2e-3);
  EXPECT_NEAR(s.v(0)[1], 0.3 - p * sine, 2e-3);
}

/// A rod on an axis through its middle: a hinge.
TEST(LockedAxes, ARodOnAHingeTurnsAsItsMomentSays) {
  constexpr double e = 0.5, arm = 0.3, mass = 2;
  Scene s = with_locked(place | locked_about(0) | locked_about(1), e, 0);
  const MassProperties box = mass_properties(Shape(Box{Vec3(0.5, 0.05, 0.05)}));
  s.add(s.shape(Box{Vec3(0.5, 0.05, 0.05)}), Vec3(50, 50, 50));
  add_unlocked(s, s.shape(Sphere{0.02}), Vec3(50 + arm, 50.2, 50), Vec3(0, -1, 0), mass);
  s.start();
  s.run(200);
  const double moment = box.inertia(2, 2) / box.volume;
  const double p = (1 + e) / (1 / mass + arm * arm / moment);
  EXPECT_NEAR(s.w(0)[2], -p * arm / moment, 1e-9);
  EXPECT_NEAR(s.v(1)[1], -1 + p / mass, 1e-9);
  EXPECT_EQ(s.x(0), Vec3(50, 50, 50));
  EXPECT_EQ(s.w(0)[0], 0);
  EXPECT_EQ(s.w(0)[1], 0);
}

TEST(LockedAxes, AlongOneTheVelocityStays) {
  Scene s = with_locked(locked_along(2) | locked_along(0), 0, 0.3);
  s.world.gravity = Vec3(1, 2, -g);
  s.add(s.shape(Sphere{0.1}), Vec3(50, 50, 50), Vec3(0.25, 0, 0));
  s.start();
  s.run(1000);
  EXPECT_EQ(s.v(0)[0], 0.25);
  EXPECT_NEAR(s.v(0)[1], 2, 1e-12);
  EXPECT_EQ(s.x(0)[2], 50);
}

TEST(LockedAxes, ABallThatMayNotTurnSlides) {
  constexpr double friction = 0.2, tangent = 0.5;
  Scene s = with_locked(locked_rotations, 0, friction);
  s.world.gravity = g * Vec3(tangent, 0, -1).normalized();
  s.add(s.shape(Sphere{0.1}), Vec3(10, 10, 0.1));
  s.floor();
  s.start();
  s.run(1000);
  const double normal = g / std::sqrt(1 + tangent * tangent);
  EXPECT_NEAR(s.x(0)[0] - 10, normal * (tangent - friction) / 2, 1e-6);
  EXPECT_EQ(s.w(0), Vec3(Vec3::Zero()));
  EXPECT_EQ(s.bodies.orientation[0].coeffs(), Quat::Identity().coeffs());
}

/// A body that turns about one axis keeps its speed, however its principal axes lie.
TEST(LockedAxes, ASkewBoxTurnsEvenlyAboutItsAxis) {
  Scene s = with_locked(locked_about(0) | locked_about(1), 0, 0);
  s.add_with_id(0, s.shape(Box{Vec3(0.3, 0.1, 0.05)}), Vec3(50, 50, 50), Vec3::Zero(), Vec3(0, 0, 3), 1,
                Quat(0.8, 0.3, -0.2, 0.4).normalized());
  s.start();
  const double energy = s.w(0)[2];
  s.run(1000);
  EXPECT_NEAR(s.w(0)[2], energy, 1e-9);
  EXPECT_EQ(s.w(0)[0], 0);
  EXPECT_EQ(s.w(0)[1], 0);
  const Quat turned = rotation_by(Vec3(0, 0, 3)) * Quat(0.8, 0.3, -0.2, 0.4).normalized();
  EXPECT_NEAR(std::abs(turned.dot(s.bodies.orientation[0])), 1, 1e-9);
}

}  // namespace
}  // namespace silt::rigid::testing
