#pragma once
// What the collision tests share: the random scenes, made once, and how a query is put.
#include <string>
#include <vector>

#include "adapters/automatic/collision_factory.hpp"
#include "rigid/collision/collision_backend.hpp"
#include "tests/adapters/pair_scenes.hpp"

namespace silt::tests {

// The names of all collision backends, for tests that run on each.
inline std::vector<std::string> every_backend() {
  const auto names = adapters::backend_names();
  return {names.begin(), names.end()};
}

using Points = std::vector<rigid::ContactPoint>;

struct Scene {
  Kind a, b;
  const char* band;
  Pair pair;
  ReferenceGap reference;
};

/// Every pair of kinds, apart (1e-3..1), touching (up to 1e-7 either way), overlapping (0.001..0.3 of the
/// size) and deep in each other (up to the same centre); seeded.
const std::vector<Scene>& random_scenes();

inline Points collide(rigid::CollisionBackend& backend, const Pair& p, double tolerance = 1.0) {
  Points points;
  backend.collide(p.a, p.pose_a, p.b, p.pose_b, tolerance, points);
  return points;
}
const rigid::ContactPoint& deepest(const Points&);

/// Returns the distance of x from the surface of the shape, on either side.
double off_surface(const ConvexShape&, const Pose&, const Vec3& x);

/// A turn about an axis through the origin, in degrees.
Quat turned(double degrees, const Vec3& axis);

/// Two boxes (half edges 4, 3, 2 below and `upper` above), the upper's lower face `gap` above the lower's
/// upper one.
Pair stacked_boxes(const Vec3& upper, const Vec3& offset, double degrees_about_z, double gap);

}  // namespace silt::tests
