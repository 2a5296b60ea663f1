// Contact response by sffd against closed forms: what rigid/README.md promises of it
// that spheres, boxes and planes allow. dt = 1e-3, g = 9.81. And what a fast contact law must keep: momentum,
// cone, no tunnelling.
#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "tests/rigid/scene.hpp"

namespace silt::rigid {
namespace {

using testing::Scene;

/// Every row on every backend.
class Sffd : public ::testing::TestWithParam<const char*> {
  void SetUp() override { testing::backend_name = GetParam(); }
  void TearDown() override { testing::backend_name = "analytic"; }
};
INSTANTIATE_TEST_SUITE_P(On, Sffd, ::testing::Values("auto", "analytic", "bullet", "fcl"),
                         [](const auto& info) { return std::string(info.param); });

constexpr double g = 9.81;
const Vec3 down(0, 0, -g);

/// Gravity as seen by a slope of that angle, falling along +x.
Vec3 slope(double degrees) {
  const double a = degrees * M_PI / 180;
  return g * Vec3(std::sin(a), 0, -std::cos(a));
}

TEST_P(Sffd, HeadOnCollisionOneToTwo) {
  for (double e : {0.0, 0.5, 1.0}) {
    Scene s(e, 0);
    s.settings.max_sweeps = 1;
    const int ball = s.shape(Sphere{0.5});
    s.add(ball, {10, 10, 10}, {1, 0, 0});
    s.add(ball, {11.2, 10, 10}, Vec3::Zero(), Vec3::Zero(), 2);
    s.start();
    s.run(1000);
    EXPECT_NEAR(s.v(0)[0], (1 - 2 * e) / 3, 1e-15);
    EXPECT_NEAR(s.v(1)[0], (1 + e) / 3, 1e-15);
    EXPECT_NEAR(s.momentum()[0], 1, 1e-15);
    EXPECT_EQ(s.deepest, 0);
  }
}

TEST_P(Sffd, ObliqueImpactOnAWall) {  // rigid Coulomb (Walton): sliding and sticking
  const double e = 0.5, mu = 0.2, r = 0.5, vn = 2;
  for (double vt : {3.0, 0.5}) {
    Scene s(e, mu);
    s.add(s.shape(Sphere{r}), {10, 10, 1}, {vt, 0, -vn});
    s.floor();
    s.start();
    s.run(500);
    const bool slides = vt / vn > 3.5 * mu * (1 + e);
    const double after = slides ? vt - mu * (1 + e) * vn : 5.0 / 7 * vt;
    const double spin = slides ? 2.5 * mu * (1 + e) * vn / r : 5.0 / 7 * vt / r;
    EXPECT_NEAR(s.v(0)[0], after, 1e-13) << vt;
    EXPECT_NEAR(s.w(0)[1], spin, 1e-12) << vt;
    EXPECT_NEAR(s.v(0)[2], e * vn, 1e-14);
  }
}

TEST_P(Sffd, BouncingBallKeepsItsEnergy) {
  Scene s(1, 0);
  s.world.gravity = down;
  s.add(s.shape(Sphere{0.5}), {10, 10, 1.5});
  s.floor();
  s.start();
  s.run(20000);
  EXPECT_NEAR((s.kinetic_energy() + g * (s.x(0)[2] - 0.5)) / g - 1, 0, 8e-14);
}

TEST_P(Sffd, CorrectionOfOverlapGivesNoEnergy) {  // no speculative contacts: every bounce starts overlapping
  Scene s(1, 0);
  s.world.contact_margin = 0;
  s.world.gravity = down;
  s.add(s.shape(Sphere{0.5}), {10, 10, 1.5});
  s.floor();
  s.start();
  s.run(5000);
  EXPECT_GT(s.deepest, 1e-4);
  EXPECT_NEAR((s.kinetic_energy() + g * (s.x(0)[2] - 0.5)) / g - 1, 0, 1e-12);
}

TEST_P(Sffd, BouncingBallComesToRestInTime) {
  Scene s(0.5, 0);
  s.world.gravity = down;
  s.add(s.shape(Sphere{0.5}), {10, 10, 1.5});
  s.floor();
  s.start();
  double first = 0, rest = 0, before = 0;
  for (int i = 0; i < 2000; ++i) {
    s.run(1);
    if (first == 0 && before < 0 && s.v(0)[2] > 0) first = (i + 1) * 1e-3;
    if (s.v(0).norm() > 1e-6) rest = (i + 1) * 1e-3;
    before = s.v(0)[2];
  }
  EXPECT_NEAR(first, 0.4515236, 2e-3);
  EXPECT_NEAR(rest, 1.3545709, 5e-2);  // a step lost at each of the last bounces
}

TEST_P(Sffd, BoxAtRest) {
  for (const auto& [sweeps, warm] : {std::pair(4, true), std::pair(1, false)}) {
    Scene s(0.3, 0.5);
    s.settings.max_sweeps = sweeps;
    s.settings.warm_start = warm;
    s.world.gravity = down;
    s.add(s.shape(Box{{0.5, 0.5, 0.25}}), {10, 10, 0.25});
    s.floor();
    s.start();
    s.run(10000);
    EXPECT_LT((s.x(0) - Vec3(10, 10, 0.25)).norm(), 1e-12);
    EXPECT_LT(s.v(0).norm(), 1e-14);
  }
}

TEST_P(Sffd, BlockOnAnIncline) {
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

TEST_P(Sffd, StoppingDistanceAndToppling) {
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

TEST_P(Sffd, SlidingTurnsIntoRolling) {
  const double v0 = 1, mu = 0.2, r = 0.1;
  Scene s(0, mu);
  s.world.gravity = down;
  s.add(s.shape(Sphere{r}), {10, 10, r}, {v0, 0, 0});
  s.floor();
  s.start();
  double time = 0;
  for (int i = 0; i < 1000 && time == 0; ++i) {
    s.run(1);
    if (std::abs(s.v(0)[0] - r * s.w(0)[1]) < 1e-9) time = (i + 1) * 1e-3;
  }
  EXPECT_NEAR(time, 2 * v0 / (7 * mu * g), 1e-3);
  s.run(100);
  EXPECT_NEAR(s.v(0)[0], 5.0 / 7 * v0, 1e-13);
}

TEST_P(Sffd, RollingDownAnIncline) {
  Scene s(0, 0.5);
  s.world.gravity = slope(20);
  s.add(s.shape(Sphere{0.1}), {10, 10, 0.1});
  s.floor();
  s.start();
  s.run(1000);
  EXPECT_NEAR(s.v(0)[0] / (5.0 / 7 * g * std::sin(20 * M_PI / 180)), 1, 1e-12);
}

TEST_P(Sffd, CradleWithAGapAndTouching) {
  for (double gap : {5e-3, 0.0}) {
    Scene s(1, 0);
    const int ball = s.shape(Sphere{0.5});
    s.add(ball, {10, 10, 10}, {1, 0, 0});
    s.add(ball, {11.2, 10, 10});
    s.add(ball, {12.2 + gap, 10, 10});
    s.start();
    s.run(500);
    const Vec3 expected =
        gap > 0 ? Vec3(0, 0, 1) : Vec3(-1. / 3, 2. / 3, 2. / 3);  // touching: simultaneous law
    const double tolerance = gap > 0 ? 1e-12 : 2e-3;              // 16 sweeps of a chain
    for (int k = 0; k < 3; ++k) EXPECT_NEAR(s.v(k)[0], expected[k], tolerance) << gap;
    EXPECT_NEAR(s.momentum()[0], 1, 1e-15);
  }
}

TEST_P(Sffd, LiftOff) {
  Scene s(0, 0.5);
  s.world.gravity = down;
  s.add(s.shape(Sphere{0.1}), {10, 10, 0.1});
  s.floor();
  s.start();
  for (int i = 0; i < 1000; ++i) {
    s.bodies.add_force(0, {0, 0, 1.25 * g});
    s.run(1);
  }
  EXPECT_NEAR(s.x(0)[2] - 0.1, 0.5 * 0.25 * g, 1e-10);
}

TEST_P(Sffd, GalileanInvariance) {
  const auto after = [](const Vec3& frame) {
    Scene s(0.5, 0.3);
    const int ball = s.shape(Sphere{0.5});
    // binary fractions, so that the frame's own motion is exact
    s.add(ball, {50, 50, 50}, Vec3(1, 0.25, 0) + frame, {0, 1, 0.5});
    s.add(ball, {51.25, 50.25, 50}, frame);
    s.start();
    s.run(512, 1.0 / 1024);
    EXPECT_GT((s.v(1) - frame).norm(), 0.1);
    return std::array<Vec3, 4>{s.v(0) - frame, s.v(1) - frame, s.w(0), s.w(1)};
  };
  const auto still = after(Vec3::Zero()), moving = after({3, -2, 5});
  for (int k = 0; k < 4; ++k) EXPECT_LT((still[k] - moving[k]).norm(), 2e-13);
}

TEST_P(Sffd, ImplosionKeepsMomentum) {
  for (double e : {0.5, 1.0})
    for (int sweeps : {4, 16}) {
      Scene s(e, 0.3, Vec3::Constant(20));
      s.settings.max_sweeps = sweeps;
      const int ball = s.shape(Sphere{0.5});
      std::mt19937 random(3);
      std::uniform_real_distribution<> u(-0.05, 0.05);
      double scale = 0;
      for (int i = 0; i < 27; ++i) {
        const Vec3 d(i % 3 - 1, i / 3 % 3 - 1, i / 9 - 1);
        s.add(ball, Vec3::Constant(10) + 1.2 * d + Vec3(u(random), u(random), u(random)),
              -d + Vec3(u(random), u(random), u(random)));
        scale += s.v(i).norm();
      }
      s.start();
      const Vec3 p = s.momentum(), l = s.angular_momentum();
      const double energy = s.kinetic_energy();
      s.run(1000);
      EXPECT_LT((s.momentum() - p).norm() / scale, 4e-15);
      // about the domain's corner, 17 radii away; the position correction at 4 sweeps shifts bodies a little
      EXPECT_LT((s.angular_momentum() - l).norm() / scale, 1e-11);
      EXPECT_LE(s.kinetic_energy(), energy);
      EXPECT_GT(s.kinetic_energy(), (e == 1 ? 0.5 : 0.05) * energy);
      EXPECT_LT(s.deepest, 5e-4);
    }
}

TEST_P(Sffd, TaperedStackOfTenBoxes) {
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

TEST_P(Sffd, NoTunnelling) {  // one and a half radii a step
  Scene s(0.5, 0);
  s.world.contact_margin = 10;
  s.add(s.shape(Sphere{0.1}), {10, 10, 1.03}, {0, 0, -150});
  s.floor();
  s.start();
  s.run(20);
  EXPECT_EQ(s.deepest, 0);
  EXPECT_NEAR(s.v(0)[2], 75, 1e-12);
}

TEST_P(Sffd,
       MovingWallDragsABall) {  // conveyor at 1 m/s: ends rolling on it at 2/7 of its speed... of the belt
  Scene s(0, 0.5);
  s.world.gravity = down;
  s.add(s.shape(Sphere{0.1}), {10, 10, 0.1});
  s.floor({1, 0, 0});
  s.start();
  s.run(2000);
  EXPECT_NEAR(s.v(0)[0], 2.0 / 7, 1e-12);
  EXPECT_EQ(s.x(first_wall_id + 4), Vec3::Zero()) << "the wall itself stays";
}

TEST_P(Sffd, BedOfSpheresSettles) {
  Scene s(0.3, 0.4, {1, 1, 10});
  s.extent.periodic = {true, true, false};
  s.world.gravity = down;
  s.settings.max_sweeps = 16;
  const int ball = s.shape(Sphere{0.1});
  std::mt19937 random(3);
  std::uniform_real_distribution<> u(-0.004, 0.004);
  for (int i = 0; i < 80; ++i)
    s.add(ball, {0.125 + 0.25 * (i % 4) + u(random), 0.125 + 0.25 * (i / 4 % 4) + u(random),
                 0.2 + 0.25 * (i / 16)});
  s.floor();
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

TEST_P(Sffd, BedOf125SpheresAtFourSweeps) {  // the deepest overlap of any contact in any step of a span
  Scene s(0.3, 0.4, {1, 1, 10});
  s.extent.periodic = {true, true, false};
  s.world.gravity = down;
  s.settings.max_sweeps = 4;
  const int ball = s.shape(Sphere{0.08});
  std::mt19937 random(5);
  std::uniform_real_distribution<> u(-0.004, 0.004);
  for (int i = 0; i < 125; ++i)
    s.add(ball, {0.1 + 0.2 * (i % 5) + u(random), 0.1 + 0.2 * (i / 5 % 5) + u(random), 0.1 + 0.2 * (i / 25)});
  s.floor();
  s.start();
  s.run(1200);
  EXPECT_LT(s.deepest, 2e-2 * 0.08) << "while it falls together";
  s.deepest = 0;
  s.run(300);
  EXPECT_LT(s.deepest, 2e-3 * 0.08) << "settled";
}

TEST_P(Sffd, StackOfTenEqualBoxesStands) {
  Scene s(0, 0.5);
  s.world.gravity = down;
  const int box = s.shape(Box{{0.5, 0.5, 0.5}});
  for (int i = 0; i < 10; ++i) s.add(box, {10, 10, 0.5 + i});
  s.floor();
  s.start();
  s.run(5000);
  for (int i = 0; i < 10; ++i) EXPECT_LT((s.x(i) - Vec3(10, 10, 0.5 + i)).norm(), 1e-3) << i;
  EXPECT_LT(s.v(9).norm(), 1e-6);
}

TEST_P(Sffd, CrookedStackComesToRest) {  // each box a twentieth of an edge beside the one below
  Scene s(0, 0.5);
  s.world.gravity = down;
  const int box = s.shape(Box{{0.1, 0.1, 0.1}});
  const double offsets[5][2] = {{0, 0}, {1, 0}, {1, 1}, {0, 1}, {0, 0}};
  std::array<Vec3, 5> start, settled;
  for (int i = 0; i < 5; ++i) {
    start[i] = {10 + 0.01 * offsets[i][0], 10 + 0.01 * offsets[i][1], 0.1 + 0.2 * i};
    s.add(box, start[i], Vec3::Zero(), Vec3::Zero(), 8);
  }
  s.floor();
  s.start();
  s.run(2000);
  for (int i = 0; i < 5; ++i) settled[i] = s.x(i);
  s.run(3000);
  for (int i = 0; i < 5; ++i) {
    EXPECT_LT((settled[i] - start[i]).norm(), 5e-5) << i << ": while the corners share out the weight";
    EXPECT_LT((s.x(i) - settled[i]).norm(), 1e-8) << i;
    EXPECT_LT(s.v(i).norm() + s.w(i).norm(), 1e-8) << i;
  }
}

TEST_P(Sffd,
       PressedContactsHoverByAHairAtMost) {  // a ball that rolls over another one lifts off at each step
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

TEST_P(Sffd, OverlapIsTakenBackWithoutSpeed) {
  Scene s(0, 0);
  const int ball = s.shape(Sphere{0.5});
  s.add(ball, {10, 10, 10});
  s.add(ball, {10.9, 10, 10});
  s.start();
  s.run(200);
  EXPECT_NEAR(s.x(1)[0] - s.x(0)[0], 1, 1e-8);
  EXPECT_EQ(s.kinetic_energy(), 0);
}

TEST_P(Sffd, NothingTouchesNothingHappens) {
  Scene s(0, 0);
  const int ball = s.shape(Sphere{0.5});
  s.add(ball, {10, 10, 10}, {1, 0, 0});
  s.add(ball, {40, 10, 10}, {-1, 0, 0});
  s.start();
  s.run(100);
  EXPECT_EQ(s.report.pairs, 0u);
  EXPECT_EQ(s.backend->counters().queries, 0u);
  EXPECT_EQ(s.report.resolver.sweeps, 0);
}

}  // namespace
}  // namespace silt::rigid
