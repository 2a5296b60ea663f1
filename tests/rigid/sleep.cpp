// Bodies at rest are held, wake by what would move them, and then do what they would have done awake.
#include <gtest/gtest.h>

#include <cmath>

#include "tests/rigid/beds.hpp"

namespace silt::rigid::testing {
namespace {

// a step lasts 1
constexpr double weight = 1e-6 * g;
const Vec3 down{0, 0, -weight};
constexpr double speed = 1e-6;
constexpr SleepRule rule{speed, 102};  // a thousandth of gravity

void run(Scene& s, int steps) {
  s.run(steps, 1);
}

Scene sleepy(double restitution, double friction) {
  Scene s(restitution, friction);
  s.world.gravity = down;
  s.world.sleep = rule;
  return s;
}

std::size_t at_rest(const Scene& s) {
  std::size_t n = 0;
  for (std::size_t row = 0; row < s.bodies.owned; ++row) n += s.bodies.is_at_rest(row);
  return n;
}

/// Boxes of edge 1 and ids from 0 upwards, until all are asleep.
void stack(Scene& s, int boxes) {
  const int box = s.shape(Box{{0.5, 0.5, 0.5}});
  for (int i = 0; i < boxes; ++i) s.add(box, {10, 10, 0.5 + i});
  s.floor();
  s.start();
  run(s, rule.steps + 100);
  ASSERT_EQ(at_rest(s), std::size_t(boxes));
}

TEST(Sleep, ABoxOnTheFloorSleepsAndItsContactsCostNothing) {
  Scene s = sleepy(0, 0.5);
  stack(s, 1);
  const BodyId box = 0;
  const Vec3 x = s.x(box);
  run(s, 500);
  EXPECT_EQ(at_rest(s), 1u);
  EXPECT_EQ(s.report.pairs, 0u);
  EXPECT_EQ(s.report.resolver.contacts, 0u);
  EXPECT_EQ(s.x(box), x);
  const Rest& rest = s.bodies.rest[s.row(box)];
  EXPECT_NEAR(rest.impulse[2], weight, 1e-9 * weight) << "the floor bears the weight";
  for (const double angular : rest.angular_impulse) EXPECT_NEAR(angular, 0, 1e-9 * weight);
}

TEST(Sleep, NothingThatGravityMovesSleeps) {
  Scene s = sleepy(0, 0.1);
  const BodyId thrown = s.add(s.shape(Sphere{0.5}), {10, 10, 50}, {0, 0, 1e-3});  // stops at the top
  s.start();
  for (int i = 0; i < 1000; ++i) {
    run(s, 1);
    ASSERT_EQ(at_rest(s), 0u) << i;
  }
  EXPECT_NEAR(s.v(thrown).z(), 1e-3 - 1000 * weight, 1e-12);
}

/// It would have to give twice the speed in the rule's steps.
TEST(Sleep, AForceWakesWhereItExceedsTheBalance) {
  for (const double share : {1.5, 3.0, 1000.0}) {
    Scene s = sleepy(0, 0);
    stack(s, 1);
    const BodyId box = 0;
    const double force = share * rule.speed / rule.steps * s.bodies.mass[s.row(box)];
    constexpr int steps = 500;
    for (int i = 0; i < steps; ++i) {
      s.bodies.add_force(s.row(box), {force, 0, 0});
      run(s, 1);
    }
    EXPECT_EQ(at_rest(s), share < 2 ? 1u : 0u);
    if (share < 2) continue;
    // leaves 1 - exp(-t) of its speed: so long to twice the speed
    const double late = share > 100 ? 1 : rule.steps * std::log(share / (share - 2));
    EXPECT_NEAR(s.v(box).x(), (steps - late) * force, 2 * force) << share;
  }
}

/// A ball that sleeps is hit as one awake: a ball on a plane without friction is hit centrally.
TEST(Sleep, AnImpactIsThatOnABodyAwake) {
  constexpr double hit = 2e-3;
  for (const double restitution : {0.0, 0.4, 1.0})
    for (const double mass : {0.1, 1.0, 20.0}) {
      Scene s = sleepy(restitution, 0);
      const int ball = s.shape(Sphere{0.5});
      const BodyId target = s.add(ball, {10, 10, 0.5});
      s.floor();
      s.start();
      run(s, rule.steps + 50);
      ASSERT_EQ(at_rest(s), 1u);
      const BodyId other = s.add(ball, {8, 10, 0.5}, {hit, 0, 0}, Vec3::Zero(), mass);
      run(s, 700);
      const double common = mass * hit / (1 + mass);
      EXPECT_NEAR(s.v(target).x(), (1 + restitution) * common, 1e-6 * hit) << mass << ' ' << restitution;
      EXPECT_NEAR(s.v(other).x(), hit - (1 + restitution) * hit / (1 + mass), 1e-6 * hit)
          << mass << ' ' << restitution;
    }
}

TEST(Sleep, AStackWakesFromBelow) {
  Scene s = sleepy(0, 0.3);
  stack(s, 5);
  s.bodies.set_velocity(s.row(0), {0.04, 0, 0}, Vec3::Zero());  // drawn away
  run(s, 100);
  EXPECT_EQ(at_rest(s), 0u);
  EXPECT_LT(s.v(4).z(), -0.5e-3) << "all that stood on it fall";
}

TEST(Sleep, AStackWakesByALoadThatIsPutOnGently) {
  Scene s = sleepy(0, 0.5);
  stack(s, 3);
  s.add(0, {10.4, 10, 3.5}, Vec3::Zero(), Vec3::Zero(), 2);
  run(s, 4);
  EXPECT_EQ(at_rest(s), 0u) << "each body feels it through the one above";
  run(s, 30 * rule.steps);
  ASSERT_EQ(at_rest(s), 4u);
  EXPECT_NEAR(s.bodies.rest[s.row(0)].impulse[2], weight, 1e-3 * weight) << "its own weight is what is left";
  double on_floor = 0;
  for (const StoredImpulse& p : s.bodies.stored_impulses[s.row(0)])
    if (is_wall(p.partner)) on_floor -= p.impulse.z();
  EXPECT_NEAR(on_floor, 5 * weight, 5e-3 * weight);
}

TEST(Sleep, WhatABeltCarriesStaysAwake) {
  Scene s = sleepy(0, 0.5);
  const BodyId box = s.add(s.shape(Box{{0.5, 0.5, 0.5}}), {10, 10, 0.5});
  s.floor({0.1 * speed, 0, 0});
  s.start();
  run(s, 5 * rule.steps);
  EXPECT_EQ(at_rest(s), 0u);
  EXPECT_NEAR(s.v(box).x(), 0.1 * speed, 1e-9 * speed);
}

/// A bed with sleep is compared with one without: where its bodies are when it has come to rest.
TEST(Sleep, ABedIsWhereItWouldBeAwake) {
  const auto bed = [](bool sleeps) {
    Scene s = layers_of_spheres(0.2, 0.4, down);
    if (sleeps) s.world.sleep = rule;
    s.start();
    run(s, 6000);
    return s;
  };
  const Scene asleep = bed(true), awake = bed(false);
  EXPECT_GT(at_rest(asleep), 75u);
  double mean = 0;
  for (std::size_t row = 0; row < 80; ++row)
    mean += (asleep.bodies.position[row] - awake.bodies.position[row]).norm() / 80;
  EXPECT_LT(mean, 0.01 * 0.1) << "of a radius";
  EXPECT_LT(asleep.report.resolver.contacts, awake.report.resolver.contacts / 4);
}

}  // namespace
}  // namespace silt::rigid::testing
