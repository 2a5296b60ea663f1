#pragma once
// "analytic": every pair in closed form, no engine.
#include "rigid/collision_backend.hpp"

namespace silt::adapters {

class AnalyticBackend : public rigid::CollisionBackend {
 public:
  std::string_view name() const override { return "analytic"; }
  /// Every bounded convex shape against every convex shape.
  bool supports(const rigid::ConvexShape& a, const rigid::ConvexShape& b) const override;
  void collide(const rigid::ConvexShape& a, const rigid::Pose& pose_a, const rigid::ConvexShape& b,
               const rigid::Pose& pose_b, double tolerance, std::vector<rigid::ContactPoint>& out) override;
};

}  // namespace silt::adapters
