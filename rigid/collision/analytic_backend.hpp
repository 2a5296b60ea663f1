#pragma once
// "analytic": closed forms and Newton's method, no engine.
#include "rigid/collision/collision_backend.hpp"

namespace silt::rigid {

class AnalyticBackend : public CollisionBackend {
 public:
  std::string_view name() const override { return "analytic"; }
  /// Spheres, capsules and boxes by closed forms (deepest_separation), anything on a half-space by its
  /// vertices, rims and supports, all other pairs by deepest_direction.
  void collide(const ConvexShape& a, const Pose& pose_a, const ConvexShape& b, const Pose& pose_b,
               double tolerance, std::vector<ContactPoint>& out) override;
};

}  // namespace silt::rigid
