#pragma once
// "analytic": closed forms and Newton's method, no engine.
#include "rigid/collision/collision_backend.hpp"

namespace silt::rigid {

class AnalyticBackend : public CollisionBackend {
 public:
  std::string_view name() const override { return "analytic"; }
  /// Every bounded convex shape against every convex shape, polyhedra of up to some 10000 vertices. Spheres,
  /// capsules and boxes by closed forms (deepest_separation), anything on a half-space by its vertices, rims
  /// and supports, all other pairs by proven_direction.
  bool supports(const ConvexShape& a, const ConvexShape& b) const override;
  void collide(const ConvexShape& a, const Pose& pose_a, const ConvexShape& b, const Pose& pose_b,
               double tolerance, std::vector<ContactPoint>& out) override;
};

}  // namespace silt::rigid
