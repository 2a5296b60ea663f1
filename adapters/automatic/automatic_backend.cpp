#include "adapters/automatic/automatic_backend.hpp"

#include <algorithm>

#include "adapters/common/engine_backend.hpp"

namespace silt::adapters {

using namespace rigid;

namespace {

/// Whether the deepest of the points from `first` on (there is one) lies between the shapes' supporting
/// planes.
bool supported(const Query& q, const std::vector<ContactPoint>& points, std::size_t first) {
  const auto deepest =
      std::min_element(points.begin() + first, points.end(),
                       [](const ContactPoint& p, const ContactPoint& r) { return p.gap < r.gap; });
  const double size =
      (q.pose_b.position - q.pose_a.position).norm() + (deepest->on_a - q.pose_a.position).norm();
  return std::abs(support_gap(q, deepest->normal) - deepest->gap) <= answer_tolerance * size;
}

/// Whether the answer comes from a search: not for a half-space, nor for a sphere and a sphere, capsule or
/// box.
bool needs_search(const ConvexShape& a, const ConvexShape& b) {
  if (std::holds_alternative<Sphere>(a) && std::holds_alternative<Sphere>(b)) return false;
  if (std::holds_alternative<HalfSpace>(b)) return false;
  const auto is_box = [](const ConvexShape& s) { return convex_core(s, Pose{}).is_box; };
  const bool with_sphere = std::holds_alternative<Sphere>(a) || std::holds_alternative<Sphere>(b);
  return !(with_sphere && is_box(a) && is_box(b));
}

}  // namespace

AutomaticBackend::AutomaticBackend(std::vector<std::unique_ptr<CollisionBackend>> engines)
    : engines_(std::move(engines)) {
  if (engines_.empty()) engines_.push_back(std::make_unique<AnalyticBackend>());  // for its trees
}

void AutomaticBackend::find_triangles(const SharedMesh& mesh, const BoundingBox& near,
                                      std::vector<std::uint32_t>& out) {
  engines_[0]->triangles_near(mesh, near, out);
}

void AutomaticBackend::find_triangle_pairs(const SharedMesh& a, const Pose& pose_a, const SharedMesh& b,
                                           const Pose& pose_b, double margin,
                                           std::vector<TrianglePair>& out) {
  engines_[0]->triangle_pairs_near(a, pose_a, b, pose_b, margin, out);
}

void AutomaticBackend::collide(const ConvexShape& a, const Pose& pose_a, const ConvexShape& b,
                               const Pose& pose_b, double tolerance, std::vector<ContactPoint>& out) {
  const std::size_t first = out.size();
  AnalyticBackend::collide(a, pose_a, b, pose_b, tolerance, out);
  if (out.size() == first || !needs_search(a, b)) return;
  const Query q{a, b, pose_a, pose_b, tolerance};
  for (const auto& engine : engines_) {
    if (supported(q, out, first)) return;
    ++counters_.fallbacks;
    out.resize(first);
    engine->collide(a, pose_a, b, pose_b, tolerance, out);
    if (out.size() == first) return;
  }
}

}  // namespace silt::adapters
