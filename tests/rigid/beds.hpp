#pragma once
// Beds of spheres that several tests let settle.
#include <random>

#include "tests/rigid/scene.hpp"

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

}  // namespace silt::rigid::testing
