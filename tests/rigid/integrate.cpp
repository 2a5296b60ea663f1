// Free motion: what torque-free rotation conserves, and when it tumbles.
#include "rigid/rigid_step.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/rigid/scene.hpp"
#include "tests/rigid/shapes/solids.hpp"

namespace silt::rigid {
namespace {

testing::Scene spinning(const Vec3& inertia, const Vec3& omega) {
  testing::Scene s(0, 0);
  s.add(s.shape(Sphere{0.5}), {50, 50, 50}, {0.1, 0, 0});
  s.bodies.inertia_B[0] = inertia.asDiagonal();
  s.bodies.set_velocity(0, {0.1, 0, 0}, omega);
  return s;
}

Vec3 body_spin(const testing::Scene& s) {
  return s.bodies.orientation[0].conjugate() * s.bodies.angular_velocity[0];
}

/// Time between two flips of a torque-free body spinning about its middle axis: 2 K(k) / rate (Landau,
/// Lifshitz, Mechanics, section 37). Moments of inertia ascending; omega in their axes.
double time_of_a_flip(Vec3 inertia, const Vec3& omega) {
  const Vec3 l = inertia.cwiseProduct(omega);
  const double twice_energy = l.dot(omega), square = l.squaredNorm();
  if (square < twice_energy * inertia[1]) std::swap(inertia[0], inertia[2]);
  const double rate = std::sqrt((inertia[2] - inertia[1]) * (square - twice_energy * inertia[0]) /
                                (inertia[0] * inertia[1] * inertia[2]));
  const double k = std::sqrt((inertia[1] - inertia[0]) * (twice_energy * inertia[2] - square) /
                             ((inertia[2] - inertia[1]) * (square - twice_energy * inertia[0])));
  return 2 * std::comp_ellint_1(k) / rate;
}

TEST(Integrate, BodiesOfThreeMomentsFlipOnTime) {  // 1000 steps a period, ten periods
  for (const Shape& shape : {Shape(Box{{0.5, 0.35, 0.2}}), Shape(Ellipsoid{{0.6, 0.4, 0.3}}),
                             Shape(testing::octahedron({0.6, 0.45, 0.25}))}) {
    testing::Scene s(0, 0);
    s.add(s.shape(shape), {50, 50, 50});
    const Vec3 inertia = s.bodies.inertia_B[0].diagonal(), omega(0.02, 3, 0.02);  // I ascends with its axis
    s.bodies.set_velocity(0, Vec3::Zero(), omega);
    s.start();
    const double half = time_of_a_flip(inertia, omega), energy = s.bodies.kinetic_energy(0);
    const Vec3 momentum = s.bodies.angular_momentum[0];
    std::vector<double> flips;
    double energy_drift = 0, momentum_drift = 0;
    for (int i = 0; i < 10000; ++i) {
      const double dt = half / 500, before = body_spin(s)[1];
      s.run(1, dt);
      const double after = body_spin(s)[1];
      if (before * after <= 0) flips.push_back((i + before / (before - after)) * dt);
      const double length = (s.bodies.inertia_B[0] * body_spin(s)).norm();
      energy_drift = std::max(energy_drift, std::abs(s.bodies.kinetic_energy(0) / energy - 1));
      momentum_drift = std::max(momentum_drift, std::abs(length / momentum.norm() - 1));
    }
    ASSERT_GE(flips.size(), 19u) << shape_name(shape);
    for (std::size_t i = 1; i < flips.size(); ++i)
      EXPECT_NEAR((flips[i] - flips[i - 1]) / half, 1, 1e-3) << shape_name(shape);
    EXPECT_LT(energy_drift, 1e-8) << shape_name(shape);
    EXPECT_LT(momentum_drift, 1e-8) << shape_name(shape);
  }
}

TEST(Integrate, SymmetricTopPrecesses) {
  // world-frame precession L / I1 about L
  testing::Scene s = spinning({1, 1, 1.6}, {0.3, 0, 2});
  s.start();
  const Vec3 l = s.bodies.angular_momentum[0];
  const double rate = l.norm() / 1.0, dt = 1e-3;
  const int steps = static_cast<int>(std::lround(2 * M_PI / rate / dt));
  const Vec3 axis = s.bodies.orientation[0] * Vec3::UnitZ();
  s.run(steps, 2 * M_PI / rate / steps);
  EXPECT_LT((s.bodies.orientation[0] * Vec3::UnitZ() - axis).norm(), 1e-5);
}

TEST(Integrate, LargeStepsStayBounded) {  // the Newton iteration also converges where a fixed point would not
  testing::Scene s = spinning({1, 2, 3}, {2, 5, 1});
  s.start();
  const double energy = s.bodies.kinetic_energy(0);
  s.run(200, 0.5);
  EXPECT_NEAR(s.bodies.kinetic_energy(0) / energy, 1, 1e-10);
}

TEST(Integrate, PrescribedAndFixed) {
  testing::Scene s(0, 0);
  const int ball = s.shape(Sphere{0.5});
  s.add(ball, {10, 10, 10}, {1, 0, 0}, {0, 0, 2});
  s.add(ball, {20, 10, 10});
  s.bodies.motion = {Motion::prescribed, Motion::fixed};
  s.world.gravity = {0, 0, -10};
  s.start();
  s.bodies.add_force(0, {5, 5, 5});
  s.run(1000);
  EXPECT_NEAR(s.x(0)[0], 11, 1e-11);
  EXPECT_EQ(s.x(1), Vec3(20, 10, 10));
  EXPECT_NEAR(2 * std::atan2(s.bodies.orientation[0].z(), s.bodies.orientation[0].w()), 2, 1e-12);
  EXPECT_EQ(s.w(0), Vec3(0, 0, 2));
  EXPECT_EQ(s.bodies.force[0].value(), Vec3::Zero()) << "consumed";
}

TEST(Integrate, FreeFlightIsExactForAConstantForce) {
  testing::Scene s(0, 0);
  s.add(s.shape(Box{{0.1, 0.2, 0.3}}), {50, 50, 50}, {1, 2, 3});
  s.world.gravity = {0, 0, -9.81};
  s.bodies.weight_in_fluid[0] = 0.25;
  s.start();
  for (int i = 0; i < 1000; ++i) {
    s.bodies.add_force(0, {2, 0, 0});
    s.run(1);
  }
  EXPECT_NEAR(s.x(0)[0], 50 + 1 + 0.5 * 2, 1e-11);
  EXPECT_NEAR(s.x(0)[2], 50 + 3 - 0.5 * 9.81 * 0.25, 1e-11);
}

TEST(Integrate, TorqueTurnsAndSubstepsHoldIt) {
  testing::Scene s(0, 0);
  s.add(s.shape(Sphere{0.5}), {50, 50, 50});
  s.start();
  const double inertia = s.bodies.inertia_B[0](0, 0);
  s.bodies.add_torque(0, {0, 0, 3});
  s.step->advance(s.bodies, 4);  // a step of length 1
  EXPECT_NEAR(s.w(0)[2], 3 / inertia, 1e-12);
  s.step->advance(s.bodies, 4);
  EXPECT_NEAR(s.w(0)[2], 3 / inertia, 1e-12) << "the torque was consumed";
}

}  // namespace
}  // namespace silt::rigid
