// Collisions of spheres and walls by sffd against closed forms, and what a fast contact law must keep:
// momentum, energy, no tunnelling.
#include <array>
#include <random>

#include "tests/rigid/with_backend.hpp"

namespace silt::rigid::testing {
namespace {

class SffdImpacts : public WithBackend {};

/// A ball of mass 1 and speed 1 and one of mass 2 go on together: the former loses 2/3 of its velocity in the
/// one sweep that the pair needs.
TEST_F(SffdImpacts, WhatTheLastSweepChangedIsAVelocity) {
  for (const auto& [sweeps, change] : {std::pair{1, 2. / 3}, std::pair{2, 0.}}) {
    Scene s(0, 0);
    s.settings.max_sweeps = sweeps;
    const int ball = s.shape(Sphere{0.5});
    s.add(ball, {10, 10, 10}, {1, 0, 0});
    s.add(ball, {11.2, 10, 10}, Vec3::Zero(), Vec3::Zero(), 2);
    s.start();
    double largest = 0;
    for (int step = 0; step < 300; ++step) {
      s.run(1);
      largest = std::max(largest, s.report.resolver.residual);
    }
    EXPECT_NEAR(largest, change, 1e-12) << sweeps;
  }
}

// no speculative contacts: every bounce starts overlapping
TEST_F(SffdImpacts, CorrectionOfOverlapGivesNoEnergy) {
  Scene s(1, 0);
  s.world.contact_margin = 0;
  put_ball_over_floor(s, 0.5, {10, 10, 1.5});
  s.run(5000);
  EXPECT_GT(s.deepest, 1e-4);
  EXPECT_NEAR((s.kinetic_energy() + g * (s.x(0)[2] - 0.5)) / g - 1, 0, 1e-12);
}

TEST_F(SffdImpacts, GalileanInvariance) {
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

TEST_F(SffdImpacts, ImplosionKeepsMomentum) {
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

TEST_F(SffdImpacts, NoTunnelling) {  // one and a half radii a step
  Scene s(0.5, 0);
  s.world.contact_margin = 10;
  s.add(s.shape(Sphere{0.1}), {10, 10, 1.03}, {0, 0, -150});
  s.floor();
  s.start();
  s.run(20);
  EXPECT_EQ(s.deepest, 0);
  EXPECT_NEAR(s.v(0)[2], 75, 1e-12);
}

TEST_F(SffdImpacts, OverlapIsTakenBackWithoutSpeed) {
  Scene s(0, 0);
  const int ball = s.shape(Sphere{0.5});
  s.add(ball, {10, 10, 10});
  s.add(ball, {10.9, 10, 10});
  s.start();
  s.run(200);
  EXPECT_NEAR(s.x(1)[0] - s.x(0)[0], 1, 1e-8);
  EXPECT_EQ(s.kinetic_energy(), 0);
}

TEST_F(SffdImpacts, NothingTouchesNothingHappens) {
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
}  // namespace silt::rigid::testing
