#pragma once
// "auto": the best answer pair by pair.
#include <memory>

#include "adapters/analytic/analytic_backend.hpp"

namespace silt::adapters {

/// For the shapes there are, the closed forms are both the most exact (1e-13 of a cell) and the fastest
/// (tests/bench/ collision_pairs), so they answer every pair. Where the answer involves the search for
/// closest features (no sphere and no half-space among the two) it is checked against the supporting planes;
/// if it fails Bullet answers, then FCL, and the fallback is counted. A shape without closed form would go to
/// an engine here.
class AutomaticBackend : public rigid::CollisionBackend {
 public:
  AutomaticBackend();
  std::string_view name() const override { return "auto"; }
  bool supports(const rigid::ConvexShape& a, const rigid::ConvexShape& b) const override;
  void collide(const rigid::ConvexShape& a, const rigid::Pose& pose_a, const rigid::ConvexShape& b,
               const rigid::Pose& pose_b, double tolerance, std::vector<rigid::ContactPoint>& out) override;

 private:
  AnalyticBackend analytic_;
  std::unique_ptr<rigid::CollisionBackend> engines_[2];
};

}  // namespace silt::adapters
