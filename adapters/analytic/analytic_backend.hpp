#pragma once
// "analytic": closed forms and Newton's method, no engine.
#include "rigid/collision_backend.hpp"

namespace silt::adapters {

class AnalyticBackend : public rigid::CollisionBackend {
 public:
  std::string_view name() const override { return "analytic"; }
  /// Every bounded convex shape against every convex shape, polyhedra of up to some 10000 vertices. Spheres,
  /// capsules and boxes by closed forms (deepest_separation), anything on a half-space by its vertices, rims
  /// and supports, all other pairs by proven_direction.
  bool supports(const rigid::ConvexShape& a, const rigid::ConvexShape& b) const override;
  void collide(const rigid::ConvexShape& a, const rigid::Pose& pose_a, const rigid::ConvexShape& b,
               const rigid::Pose& pose_b, double tolerance, std::vector<rigid::ContactPoint>& out) override;
};

}  // namespace silt::adapters
