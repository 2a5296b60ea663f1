// Prescribed motions: their velocity is the derivative of their pose.
#include "rigid/bodies/prescribed_motion.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "rigid/math/types.hpp"

namespace silt::rigid {
namespace {

PrescribedMotion table_motion() {
  PrescribedMotion m;
  m.table = {{1, {0, 0, 0}, {0, 0, 0}},
             {3, {1, 0.5, -1}, {0.3, -0.2, 1}},
             {4, {1.5, 0, -2}, {0.5, 0.4, 2.5}},
             {8, {0, 0, 0}, {0, 0, 3}}};
  return m;
}

std::vector<PrescribedMotion> motions() {
  PrescribedMotion turn, swing, table = table_motion();
  turn.angular_velocity = {0.1, -0.3, 0.7}, turn.velocity = {0.01, 0.02, 0};
  swing.amplitude = {0.5, 0, 2}, swing.frequency = 0.07, swing.phase = 0.4;
  return {turn, swing, table};
}

TEST(PrescribedMotion, VelocityIsTheDerivativeOfThePose) {
  const Pose start{{1, 2, 3}, Quat(0.5, 0.1, -0.7, 0.3).normalized()};
  const Vec3 point(0.3, -1.2, 2);  // of the wall
  constexpr double h = 1e-5;
  for (const PrescribedMotion& m : motions())
    for (const double t : {0.5, 1.3, 2.9, 3.7, 5.1, 9.}) {
      const Pose now = m.pose(start, t), before = m.pose(start, t - h), after = m.pose(start, t + h);
      const PrescribedMotion::Velocity v = m.velocity_at(t);
      const Vec3 moved = (after.to_world(point) - before.to_world(point)) / (2 * h);
      EXPECT_LT((v.linear + v.angular.cross(now.to_world(point) - now.position) - moved).norm(), 1e-8) << t;
    }
}

TEST(PrescribedMotion, NoPointIsFasterThanItsBound) {
  constexpr double radius = 2.5;
  for (const PrescribedMotion& m : motions()) {
    double fastest = 0;
    for (double t = 0; t < 20; t += 0.01) {
      const PrescribedMotion::Velocity v = m.velocity_at(t);
      fastest = std::max(fastest, v.linear.norm() + radius * v.angular.norm());
    }
    EXPECT_LE(fastest, m.speed_bound(radius) * (1 + 1e-12));
    EXPECT_GT(fastest, 0.5 * m.speed_bound(radius)) << "the bound is of use";
  }
}

TEST(PrescribedMotion, ATableIsMetAndHeldBeforeAndAfterIt) {
  const PrescribedMotion m = table_motion();
  for (const MotionRow& row : m.table) {
    EXPECT_LT((m.pose({}, row.time).position - row.displacement).norm(), 1e-14);
    const Quat turned(Eigen::AngleAxisd(row.rotation.norm(), row.rotation.stableNormalized()));
    EXPECT_GT(std::abs(m.pose({}, row.time).orientation.dot(turned)), 1 - 1e-14);
  }
  EXPECT_EQ(m.pose({}, 100).position, m.pose({}, 8).position);
  EXPECT_EQ(m.velocity_at(100).linear.norm() + m.velocity_at(0).linear.norm(), 0);
  EXPECT_LT(m.velocity_at(1 + 1e-9).linear.norm(), 1e-8) << "it starts from rest";
}

/// A body has a pose and constant velocities in a step; with them it comes to where the motion leads.
TEST(PrescribedMotion, StepByStepItLeadsToThePose) {
  std::vector<PrescribedMotion> all = motions();
  all.push_back(all[0]);
  all.back().over_time = {{{0, 0}, {6, 2}}, 0.5, 0.1, 1};
  for (const PrescribedMotion& m : all) {
    const Pose start{{1, 2, 3}, Quat(0.5, 0.1, -0.7, 0.3).normalized()};
    Pose pose = start;
    for (int step = 0; step < 10; ++step) {
      const PrescribedMotion::Velocity v = m.over_step(step);
      pose = {pose.position + v.linear, rotation_by(v.angular) * pose.orientation};
    }
    const Vec3 gone = m.pose(start, 10).position - m.pose(start, 0).position;
    EXPECT_LT((pose.position - start.position - gone).norm(), 1e-12);
    const Quat turned = m.pose(start, 10).orientation * m.pose(start, 0).orientation.conjugate();
    EXPECT_GT(std::abs((turned * start.orientation).dot(pose.orientation)), 1 - 1e-12);
  }
}

TEST(PrescribedMotion, OnlyWhatMovesMoves) {
  EXPECT_FALSE(PrescribedMotion{}.moves());
  for (const PrescribedMotion& m : motions()) EXPECT_TRUE(m.moves());
  PrescribedMotion still;
  still.amplitude = {1, 0, 0};
  EXPECT_FALSE(still.moves()) << "without a frequency";
}

}  // namespace
}  // namespace silt::rigid
