// Rest, sliding, rolling, stacks and beds by sffd against closed forms.
#include <random>

#include "tests/rigid/scene.hpp"
#include "tests/rigid/with_backend.hpp"

namespace silt::rigid::testing {

/// Five layers of sixteen spheres of radius 0.1, ids from 0, each a little off its place, above a floor;
/// periodic to the sides. Not started.
inline Scene layers_of_spheres(double restitution, double friction, const Vec3& gravity) {
  Scene s(restitution, friction, {1, 1, 10});
  s.extent.periodic = {true, true, false};
  s.world.gravity = gravity;
  const int ball = s.shape(Sphere{0.1});
  std::mt19937 random(3);
  std::uniform_real_distribution<> u(-0.004, 0.004);
  for (int i = 0; i < 80; ++i)
    s.add(ball, {0.125 + 0.25 * (i % 4) + u(random), 0.125 + 0.25 * (i / 4 % 4) + u(random),
                 0.2 + 0.25 * (i / 16)});
  s.floor();
  return s;
}

namespace {

class SffdFriction : public WithBackend {};

TEST_F(SffdFriction, BlockOnAnIncline) {
  for (double degrees : {20.0, 25.0, 30.0}) {
    Scene s(0, 0.5);
    s.settings.max_sweeps = 4;
    s.world.gravity = slope(degrees);
    s.add(s.shape(Box{{0.5, 0.5, 0.25}}), {10, 10, 0.25});
    s.floor();
    s.start();
    s.run(2000);
    const double x = s.x(0)[0] - 10;
    if (degrees < 26) {
      EXPECT_LT(std::abs(x), 3e-10) << degrees;
    } else {
      EXPECT_NEAR(x, 1.314291, 1e-6);
      const double a = degrees * M_PI / 180;
      EXPECT_NEAR(x, 0.5 * g * (std::sin(a) - 0.5 * std::cos(a)) * 4, 2e-9);
    }
    EXPECT_LT(s.report.resolver.cone_excess, 1e-12);
  }
}

TEST_F(SffdFriction, StoppingDistanceAndToppling) {
  Scene s(0, 0.3);
  s.world.gravity = down;
  s.add(s.shape(Box{{0.5, 0.5, 0.25}}), {10, 10, 0.25}, {2, 0, 0});
  s.floor();
  s.start();
  s.run(2000);
  EXPECT_NEAR(s.x(0)[0] - 10, 4 / (2 * 0.3 * g), 2e-3);  // first order in dt: half a step of v0
  EXPECT_LT(s.v(0).norm(), 1e-12);
  for (double width : {0.45, 0.55}) {  // height 1, mu high: topples if tan(angle) > width / height
    Scene t(0, 2);
    t.world.gravity = slope(std::atan(0.5) * 180 / M_PI);
    t.add(t.shape(Box{{width / 2, 0.5, 0.5}}), {10, 10, 0.5});
    t.floor();
    t.start();
    t.run(1000);
    EXPECT_EQ(t.w(0)[1] > 0.1, width < 0.5) << width;
    if (width > 0.5) {
      EXPECT_LT(t.v(0).norm(), 1e-10);
    }
  }
}

TEST_F(SffdFriction, LiftOff) {
  Scene s(0, 0.5);
  put_ball_over_floor(s, 0.1, {10, 10, 0.1});
  for (int i = 0; i < 1000; ++i) {
    s.bodies.add_force(0, {0, 0, 1.25 * g});
    s.run(1);
  }
  EXPECT_NEAR(s.x(0)[2] - 0.1, 0.5 * 0.25 * g, 1e-10);
}

// a ball that rolls over another one lifts off at each step
TEST_F(SffdFriction, PressedContactsHoverByAHairAtMost) {
  Scene s(0, 0.5);
  s.world.gravity = down;
  const double r = 0.1;
  const int ball = s.shape(Sphere{r});
  s.add(ball, {10, 10, r}, Vec3::Zero(), Vec3::Zero(), 1e9);
  s.add(ball, {10.02, 10, r + std::sqrt(4 * r * r - 4e-4)});
  s.floor();
  s.start();
  const auto gap = [&] { return (s.x(1) - s.x(0)).norm() - 2 * r; };
  for (int i = 0; i < 50; ++i) {
    s.run(1, 5e-3);
    EXPECT_LT(gap(), 1.2e-4 * 2 * r) << i;  // half a step after the contact was looked at
  }
  EXPECT_GT((s.x(1) - s.x(0))[0], 0.04) << "it rolled";
}

class SffdBeds : public WithBackend {};

TEST_F(SffdBeds, TaperedStackOfTenBoxes) {
  for (int sweeps : {1, 4}) {
    Scene s(0, 0.5);
    s.settings.max_sweeps = sweeps;
    s.world.gravity = down;
    for (int i = 0; i < 10; ++i) {
      const double h = 0.5 - 0.04 * i;
      s.add(s.shape(Box{{h, h, 0.25}}), {10, 10, 0.25 + 0.5 * i}, Vec3::Zero(), Vec3::Zero(), 4 * h * h);
    }
    s.floor();
    s.start();
    s.run(3000);
    EXPECT_LT(s.deepest, sweeps == 1 ? 4e-3 : 9e-4) << "while the load spreads";
    EXPECT_LT(s.report.resolver.penetration, 1e-6);
    EXPECT_LT(s.v(9).norm(), sweeps == 1 ? 1e-9 : 1e-12);
    EXPECT_LT((s.x(9) - Vec3(10, 10, 4.75)).norm(), 1e-5);
  }
}

TEST_F(SffdBeds, AChainBearsItsLoadFromTheFirstStepOn) {  // statics: each contact has all that is above it
  constexpr int light = 12;
  constexpr double ratio = 1e3, dt = 1e-3;
  Scene s(0, 0.5);
  s.world.gravity = down;
  const int box = s.shape(Box{{0.5, 0.5, 0.5}});
  for (int i = 0; i <= light; ++i)
    s.add(box, {10, 10, 0.5 + i}, Vec3::Zero(), Vec3::Zero(), i == light ? ratio : 1);
  s.floor();
  s.start();
  s.run(1, dt);
  for (int i = 0; i <= light; ++i) {
    EXPECT_LT(s.v(i).norm(), 1e-6 * down.norm() * dt) << i;
    double borne = 0;
    for (const StoredImpulse& p : s.bodies.stored_impulses[s.row(i)])
      if (p.partner == BodyId(i + 1)) borne += p.impulse.z();
    const double above = i < light ? light - i - 1 + ratio : 0;
    EXPECT_NEAR(borne, above * down.norm() * dt, 1e-6 * ratio * down.norm() * dt) << i;
  }
}

TEST_F(SffdBeds, BedOfSpheresSettles) {
  Scene s = layers_of_spheres(0.3, 0.4, down);
  s.settings.max_sweeps = 16;
  s.start();
  s.run(1200);
  EXPECT_LT(s.deepest, 3e-2 * 0.1) << "while it falls together";
  s.deepest = 0;
  s.run(300);
  EXPECT_LT(s.deepest, 6.8e-4 * 10 * 0.1);
  EXPECT_LT(s.kinetic_energy() / 80, 0.02);
  EXPECT_GT(s.report.resolver.contacts, 120u);
  EXPECT_LT(s.report.resolver.cone_excess, 1e-12);
}

}  // namespace

}  // namespace silt::rigid::testing
