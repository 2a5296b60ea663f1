#pragma once
// "auto": the best answer pair by pair.
#include <memory>
#include <vector>

#include "rigid/collision/analytic_backend.hpp"

namespace silt::adapters {

/// The analytic backend's own methods are both the most exact (1e-12 of a cell) and the fastest of all for
/// every pair (table in adapters/README.md), so they answer. Where the answer involves a search (no
/// half-space, and no sphere among spheres, capsules and boxes) it is checked against the supporting planes;
/// if it fails Bullet answers, then FCL, of those that this build has, and the fallback is counted. A shape
/// that an engine knows better would go to it here.
class AutomaticBackend : public rigid::CollisionBackend {
 public:
  AutomaticBackend();
  std::string_view name() const override { return "auto"; }
  bool supports(const rigid::ConvexShape& a, const rigid::ConvexShape& b) const override;
  void collide(const rigid::ConvexShape& a, const rigid::Pose& pose_a, const rigid::ConvexShape& b,
               const rigid::Pose& pose_b, double tolerance, std::vector<rigid::ContactPoint>& out) override;

 protected:
  bool finds_triangles() const override { return true; }
  /// Both by Bullet's tree, the fastest for small bodies (adapters/README.md); which one is asked shows in no
  /// contact.
  void find_triangles(const SharedMesh&, const rigid::BoundingBox& near,
                      std::vector<std::uint32_t>& out) override;
  void find_triangle_pairs(const SharedMesh& a, const rigid::Pose& pose_a, const SharedMesh& b,
                           const rigid::Pose& pose_b, double margin,
                           std::vector<rigid::TrianglePair>& out) override;

 private:
  rigid::AnalyticBackend analytic_;
  std::vector<std::unique_ptr<rigid::CollisionBackend>> engines_;  // of this build; never empty
};

}  // namespace silt::adapters
