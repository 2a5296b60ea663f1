// Friction against rolling and twisting, against theory.
#include <gtest/gtest.h>

#include <cmath>

#include "rigid/math/types.hpp"
#include "tests/rigid/response/flat_grounds.hpp"

namespace silt::rigid::testing {
namespace {

/// A ball on a plane inclined by an angle with this tangent: gravity is tilted instead.
Scene ball_on_slope(double tangent, double rolling_friction, const Shape& shape = Sphere{ball_radius}) {
  Scene s(0, 0.9);
  s.world.materials[0].rolling_friction = rolling_friction;
  s.world.gravity = g * Vec3(tangent, 0, -1).normalized();
  s.add(s.shape(shape), Vec3(10, 10, ball_radius));
  s.floor();
  s.start();
  return s;
}

double normal_gravity(double tangent) {
  return g / std::sqrt(1 + tangent * tangent);
}

TEST(RollingFriction, ABallStartsOnASlopeAboveItsCoefficient) {
  for (const double coefficient : {0.05, 0.2}) {
    Scene stays = ball_on_slope(0.99 * coefficient, coefficient);
    stays.run(1000, time_step);
    EXPECT_LT((stays.x(0) - Vec3(10, 10, ball_radius)).norm(), 1e-9) << coefficient;
    const double tangent = 1.5 * coefficient;
    Scene rolls = ball_on_slope(tangent, coefficient);
    rolls.run(1000, time_step);
    const double a = 5. / 7 * normal_gravity(tangent) * (tangent - coefficient);
    EXPECT_NEAR(rolls.x(0)[0] - 10, a / 2, 1e-6 * a) << coefficient;
    EXPECT_NEAR(rolls.w(0)[1] * ball_radius, rolls.v(0)[0], 1e-9) << coefficient;
  }
}

/// On a plate of any form and thickness as on a wall.
TEST(RollingFriction, IsThatOfTheBallOnAPlate) {
  constexpr double coefficient = 0.05;
  const Quat lying = rotation_between(Vec3::UnitZ(), Vec3::UnitY());
  for (const auto& plate : flat_grounds())
    for (const double tangent : {0.04, 0.1})
      for (const bool ball : {true, false}) {
        Scene s = ball ? on_plate(plate, Sphere{ball_radius}, ball_radius)
                       : on_plate(plate, Cylinder{ball_radius, 0.3}, ball_radius, lying);
        s.world.materials[0].rolling_friction = coefficient;
        s.world.gravity = g * Vec3(tangent, 0, -1).normalized();
        s.start();
        s.run(500, time_step);
        const double a =
            (ball ? 5. / 7 : 2. / 3) * normal_gravity(tangent) * std::max(0., tangent - coefficient);
        EXPECT_NEAR(s.x(0)[0] - 10, a / 8, (ball ? 1e-5 : 0.01) * a + 1e-6)
            << shape_name(plate.first) << ' ' << plate.second << ' ' << tangent << ' ' << ball;
      }
}

/// Friction that cannot make it roll leaves it sliding.
TEST(RollingFriction, ABallSlidesWhereSlipIsTheEasier) {
  Scene s = ball_on_slope(0.5, 0.4);
  s.world.materials[0].friction = s.settings.materials[0].friction = 0.3;
  s.start();
  s.run(1000, time_step);
  EXPECT_NEAR(s.x(0)[0] - 10, normal_gravity(0.5) * (0.5 - 0.3) / 2, 1e-6);
  EXPECT_LT(s.w(0).norm(), 1e-9);
}

TEST(RollingFriction, ARollingBallStops) {
  constexpr double coefficient = 0.1, speed = 1;
  Scene s(0, 0.9);
  s.world.materials[0].rolling_friction = coefficient;
  s.world.gravity = Vec3(0, 0, -g);
  s.add(s.shape(Sphere{ball_radius}), Vec3(10, 10, ball_radius), Vec3(speed, 0, 0),
        Vec3(0, speed / ball_radius, 0));
  s.floor();
  s.start();
  s.run(3000, time_step);
  const double deceleration = 5. / 7 * coefficient * g;
  EXPECT_NEAR(s.x(0)[0] - 10, speed * speed / (2 * deceleration), 2 * speed * time_step);
  EXPECT_LT(s.v(0).norm() + ball_radius * s.w(0).norm(), 1e-9);
}

TEST(RollingFriction, ASpinningBallStops) {
  constexpr double coefficient = 0.2, spin = 20;
  Scene s(0, 0.5);
  s.world.materials[0].twisting_friction = coefficient;
  s.world.gravity = Vec3(0, 0, -g);
  s.add(s.shape(Sphere{ball_radius}), Vec3(10, 10, ball_radius), Vec3::Zero(), Vec3(0, 0, spin));
  s.floor();
  s.start();
  const double deceleration = 2.5 * coefficient * g / ball_radius;
  s.run(200, time_step);
  EXPECT_NEAR(s.w(0)[2], spin - 0.2 * deceleration, 1e-9);
  s.run(400, time_step);
  EXPECT_LT(s.w(0).norm(), 1e-12);
}

/// Balls that fly into each other: what rubs, rolls and holds them keeps momentum, and makes no energy.
TEST(RollingFriction, AndCohesionKeepMomentumAndMakeNoEnergy) {
  for (const double restitution : {0.0, 0.8}) {
    Scene s(restitution, 0.4);
    Material& m = s.world.materials[0];
    m.rolling_friction = 0.3, m.twisting_friction = 0.2, m.cohesion = 50;
    const int ball = s.shape(Sphere{ball_radius}), rod = s.shape(Capsule{ball_radius, 0.2});
    for (int i = 0; i < 27; ++i) {
      const Vec3 at(i % 3 - 1, i / 3 % 3 - 1, i / 9 - 1);
      s.add(i % 4 ? ball : rod, Vec3::Constant(50) + 0.5 * at,
            -2 * at + Vec3(0.3 * (i % 5), 0.2 * (i % 7), 0.1 * (i % 3)), Vec3(i % 4, i % 5, i % 6),
            1 + i % 3);
    }
    s.start();
    const Vec3 p = s.momentum(), l = s.angular_momentum();
    double energy = s.kinetic_energy();
    const double start = energy;
    for (int i = 0; i < 600; ++i) {
      s.run(1, time_step);
      const double now = s.kinetic_energy();
      EXPECT_LE(now, energy + 1e-4 * start) << i;  // rods turn, and their pull opens and shuts gaps of a hair
      energy = now;
    }
    EXPECT_LT(energy, 0.9 * start);
    EXPECT_LT((s.momentum() - p).norm(), 1e-11 * start);
    EXPECT_LT((s.angular_momentum() - l).norm(), 2e-3 * l.norm());
  }
}

}  // namespace
}  // namespace silt::rigid::testing
