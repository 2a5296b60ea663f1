#pragma once
// Tests of the contact response with the contacts that a run has. dt = 1e-3, g = 9.81.
#include <gtest/gtest.h>

#include <cmath>

#include "tests/rigid/scene.hpp"

namespace silt::rigid::testing {

class WithBackend : public ::testing::Test {
  void SetUp() override { backend_name = "auto"; }
  void TearDown() override { backend_name = "analytic"; }
};

/// Gravity as seen by a slope of that angle, falling along +x.
inline Vec3 slope(double degrees) {
  const double a = degrees * M_PI / 180;
  return g * Vec3(std::sin(a), 0, -std::cos(a));
}

/// Starts a scene of a ball at `x` and the floor below it.
inline void put_ball_over_floor(Scene& s, double radius, const Vec3& x) {
  s.world.gravity = down;
  s.add(s.shape(Sphere{radius}), x);
  s.floor();
  s.start();
}

}  // namespace silt::rigid::testing
