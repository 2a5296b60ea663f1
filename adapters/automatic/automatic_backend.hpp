#pragma once
// "auto": the best answer pair by pair.
#include "rigid/collision/collision_backend.hpp"

namespace silt::adapters {

/// The analytic backend's own methods are both the most exact (1e-12 of a cell) and the fastest of all for
/// every pair (table in adapters/README.md), so they answer. Where the answer involves a search (no
/// half-space, and no sphere among spheres, capsules and boxes) it is checked against the supporting planes;
/// if it fails one engine after the other answers, and the fallback is counted. A shape that an engine knows
/// better would go to it here.
class AutomaticBackend : public rigid::AnalyticBackend {
 public:
  explicit AutomaticBackend(std::vector<std::unique_ptr<rigid::CollisionBackend>> engines);
  std::string_view name() const override { return "auto"; }
  void collide(const rigid::ConvexShape& a, const rigid::Pose& pose_a, const rigid::ConvexShape& b,
               const rigid::Pose& pose_b, double tolerance, std::vector<rigid::ContactPoint>& out) override;

 protected:
  /// Both by the first engine's tree, Bullet's, which is the fastest for small bodies; which one is asked
  /// shows in no contact.
  bool finds_triangles() const override { return true; }
  void find_triangles(const rigid::SharedMesh&, const rigid::BoundingBox& near,
                      std::vector<std::uint32_t>& out) override;
  void find_triangle_pairs(const rigid::SharedMesh& a, const rigid::Pose& pose_a, const rigid::SharedMesh& b,
                           const rigid::Pose& pose_b, double margin,
                           std::vector<rigid::TrianglePair>& out) override;

 private:
  std::vector<std::unique_ptr<rigid::CollisionBackend>> engines_;  // never empty
};

}  // namespace silt::adapters
