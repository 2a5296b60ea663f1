// Bodies that move as given, and bodies held by locked axes.
#include <gtest/gtest.h>

#include <cmath>

#include "rigid/math/types.hpp"
#include "tests/rigid/scene.hpp"

namespace silt::rigid::testing {
namespace {

using testing::g;
using testing::Scene;

Scene on_earth(double friction) {
  Scene s(0, friction);
  s.world.gravity = {0, 0, -g};
  return s;
}

/// A belt with its upper side at z = 0, going along x; a wall, or a long box that moves.
void belt(Scene& s, bool wall, double speed) {
  if (wall) return s.floor({speed, 0, 0});
  const int plank = s.shape(Box{{30, 5, 0.5}});
  const BodyId id = s.add(plank, {40, 10, -0.5}, {speed, 0, 0});
  s.bodies.motion[s.row(id)] = Motion::prescribed;
}

struct OnABelt : ::testing::TestWithParam<bool> {};
INSTANTIATE_TEST_SUITE_P(Belt, OnABelt, ::testing::Values(false, true),
                         [](const auto& i) { return i.param ? "Wall" : "Plank"; });

TEST_P(OnABelt, BallSlidesThenRolls) {  // slides until t = 2 V / (7 mu g), then v = 2 V / 7
  const double speed = 1, mu = 0.2, r = 0.1;
  Scene s = on_earth(mu);
  s.add(s.shape(Sphere{r}), {40, 10, r});
  belt(s, GetParam(), speed);
  s.start();
  const double end = 2 * speed / (7 * mu * g);
  double rolls = 0;
  for (int i = 1; i <= 1000; ++i) {
    s.run(1);
    const double t = 1e-3 * i, slip = s.v(0)[0] - r * s.w(0)[1] - speed;
    if (t < end) {
      EXPECT_NEAR(s.v(0)[0], mu * g * t, 1e-11);
      EXPECT_NEAR(r * s.w(0)[1], -2.5 * mu * g * t, 1e-11);
    } else if (rolls == 0 && std::abs(slip) < 1e-9) {
      rolls = t;
    }
  }
  EXPECT_NEAR(rolls, end, 1e-3);
  EXPECT_NEAR(s.v(0)[0], 2.0 / 7 * speed, 1e-12);
  EXPECT_NEAR(s.w(0)[1] * r, -5.0 / 7 * speed, 1e-12);
}

TEST_P(OnABelt, BoxReachesTheSpeedOfTheBelt) {
  const double speed = 1, mu = 0.3;
  Scene s = on_earth(mu);
  s.add(s.shape(Box{{0.5, 0.5, 0.25}}), {40, 10, 0.25});
  belt(s, GetParam(), speed);
  s.start();
  double reached = 0;
  for (int i = 1; i <= 1000; ++i) {
    s.run(1);
    const double t = 1e-3 * i;
    if (mu * g * t < speed) {
      EXPECT_NEAR(s.v(0)[0], mu * g * t, 1e-10);
    }
    if (reached == 0 && std::abs(s.v(0)[0] - speed) < 1e-9) reached = t;
  }
  EXPECT_NEAR(reached, speed / (mu * g), 1e-3);
  EXPECT_NEAR(s.v(0)[0], speed, 1e-12);
  EXPECT_LT(s.w(0).norm(), 1e-10);
}

TEST(PrescribedMotion, BodyOnATurntableTurnsWithIt) {
  // A step moves it along its tangent: the circle widens by omega^2 dt / 2 a unit of time, first order in dt.
  const double omega = 0.5, radius = 2;
  for (double dt : {2e-3, 1e-3}) {
    Scene s = on_earth(0.5);
    s.add(s.shape(Box{{0.25, 0.25, 0.25}}), {10 + radius, 10, 0.75}, {0, omega * radius, 0}, {0, 0, omega});
    const BodyId plate = s.add(s.shape(Box{{3, 3, 0.5}}), {10, 10, 0}, Vec3::Zero(), {0, 0, omega});
    s.bodies.motion[s.row(plate)] = Motion::prescribed;
    s.start();
    const double time = 2 * M_PI / omega;
    const int steps = static_cast<int>(std::lround(time / dt));
    s.run(steps, time / steps);
    const Vec3 arm = s.x(0) - Vec3(10, 10, 0.75);
    EXPECT_NEAR(arm.head<2>().norm() / radius, std::exp(0.5 * omega * omega * dt * time), 1e-4) << dt;
    EXPECT_NEAR(std::atan2(arm[1], arm[0]), 0, 1e-5);
    EXPECT_NEAR(s.w(0)[2], omega, 1e-9);
    EXPECT_LT((s.x(plate) - Vec3(10, 10, 0)).norm(), 1e-12);
  }
}

TEST(PrescribedMotion, TooFastATurntableLosesItsBody) {  // omega^2 r > mu g
  for (const auto& [omega, stays] : {std::pair(1.4, true), std::pair(1.8, false)}) {
    Scene s = on_earth(0.5);  // slides from omega = 1.566 on
    s.add(s.shape(Box{{0.1, 0.1, 0.02}}), {12, 10, 0.52}, {0, omega * 2, 0}, {0, 0, omega});
    const BodyId plate = s.add(s.shape(Box{{9, 9, 0.5}}), {10, 10, 0}, Vec3::Zero(), {0, 0, omega});
    s.bodies.motion[s.row(plate)] = Motion::prescribed;
    s.start();
    s.run(2000);
    const double radius = (s.x(0) - Vec3(10, 10, 0.52)).norm();
    EXPECT_EQ(radius > 2.1, !stays) << omega;
  }
}

/// Eight plates about the y axis, a compound; the inside is an octagon of inner radius 1.
Compound drum() {
  Compound c;
  for (int i = 0; i < 8; ++i) {
    const Quat q(Eigen::AngleAxisd(i * M_PI / 4, Vec3::UnitY()));
    c.parts.push_back({Box{{0.5, 1, 0.1}}, {q * Vec3(0, 0, -1.1), q}});
  }
  return c;
}

TEST(PrescribedMotion, DrumLiftsABoxUpToTheAngleOfFriction) {
  const double omega = 0.2, mu = 0.3;
  Scene s = on_earth(mu);
  s.add(s.shape(Box{{0.1, 0.1, 0.05}}), {10, 10, 9.05}, {-omega * 0.95, 0, 0}, {0, omega, 0});
  const BodyId id = s.add(s.shape(drum()), {10, 10, 10}, Vec3::Zero(), {0, omega, 0});
  s.bodies.motion[s.row(id)] = Motion::prescribed;
  s.start();
  double slides = 0;
  for (int i = 1; i <= 2000 && slides == 0; ++i) {
    s.run(1);
    const Vec3 with_the_drum = Vec3(0, omega, 0).cross(s.x(0) - Vec3(10, 10, 10));
    if ((s.v(0) - with_the_drum).norm() > 1e-3) slides = 1e-3 * i;
  }
  // It slides from g sin a = mu (g cos a + omega^2 r) on; then v = g (cos a + mu sin a) omega t^2 / 2.
  const double a = std::atan(mu), late = mu * omega * omega * 0.95 / g * std::cos(a);
  const double shown = std::sqrt(2 * 1e-3 * omega / (g * (std::cos(a) + mu * std::sin(a))));
  EXPECT_NEAR(omega * slides, a + late + shown, 3e-4);
}

TEST(PrescribedMotion, WallsAndBodiesThatPush) {  // a piston takes a ball along without bounce
  Scene s(0, 0.3);
  s.add(s.shape(Sphere{0.5}), {12, 10, 10});
  const BodyId piston = s.add(s.shape(Box{{0.5, 2, 2}}), {10, 10, 10}, {2, 0, 0});
  s.bodies.motion[s.row(piston)] = Motion::prescribed;
  s.start();
  s.run(1000);
  EXPECT_NEAR(s.v(0)[0], 2, 1e-12);
  EXPECT_GE(s.x(0)[0] - s.x(piston)[0], 1 - 1e-12);
  EXPECT_LE(s.x(0)[0] - s.x(piston)[0], 1 + 2e-3) << "taken along at most a step early";
  EXPECT_EQ(s.v(piston), Vec3(2, 0, 0));
}

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

/// A torque turns a skew box about the axes that are free alone: there I alpha is the torque.
TEST(LockedAxes, EachIsHeldByItself) {
  const Vec3 torque(1, -2, 3);
  for (int axis = 0; axis < 3; ++axis) {
    Scene s = with_locked(locked_about(axis), 0, 0);
    const Quat turn = Quat(0.8, 0.3, -0.2, 0.4).normalized();
    s.add_with_id(0, s.shape(Box{Vec3(0.3, 0.1, 0.05)}), {Vec3(50, 50, 50), turn});
    s.start();
    const Vec3 alpha = s.bodies.inverse_inertia_W(0) * torque;
    const Mat3 r = turn.toRotationMatrix();
    const Vec3 moment = r * s.bodies.inertia_B[0] * r.transpose() * alpha;
    EXPECT_EQ(alpha[axis], 0);
    for (int d = 0; d < 3; ++d) {
      if (d == axis) continue;
      EXPECT_NEAR(moment[d], torque[d], 1e-12) << axis;
    }
  }
}

/// A body that turns about one axis keeps its speed, however its principal axes lie.
TEST(LockedAxes, ASkewBoxTurnsEvenlyAboutItsAxis) {
  Scene s = with_locked(locked_about(0) | locked_about(1), 0, 0);
  s.add_with_id(0, s.shape(Box{Vec3(0.3, 0.1, 0.05)}),
                {Vec3(50, 50, 50), Quat(0.8, 0.3, -0.2, 0.4).normalized()}, Vec3::Zero(), Vec3(0, 0, 3));
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
