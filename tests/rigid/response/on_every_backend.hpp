#pragma once
// Tests of the contact response that run on every collision backend. dt = 1e-3, g = 9.81.
#include <gtest/gtest.h>

#include <cmath>

#include "tests/rigid/scene.hpp"

namespace silt::rigid::testing {

class OnEveryBackend : public ::testing::TestWithParam<const char*> {
  void SetUp() override { backend_name = GetParam(); }
  void TearDown() override { backend_name = "analytic"; }
};
inline const auto every_backend = ::testing::Values("auto", "analytic", "bullet", "fcl");
inline std::string name_of_backend(const ::testing::TestParamInfo<const char*>& info) {
  return info.param;
}

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
