#include "adapters/common/engine_backend.hpp"

#include <cmath>

#include "rigid/collision/manifold.hpp"

namespace silt::adapters {

using namespace rigid;

namespace {

/// Returns whether `answer` is the pair's separation: that of the supporting planes, and not exceeded in any
/// direction. Replaces the gap by that of the supporting planes, so that both agree bitwise.
bool confirmed(const Query& q, const ConvexCore& a, const ConvexCore& b, Answer& answer) {
  const double slack = answer_tolerance * length_scale(a, b);
  if (!(std::abs(answer.normal.squaredNorm() - 1) < 1e-6)) return false;  // also refuses NaN
  answer.normal.normalize();
  if (a.extent() > 0 && b.extent() > 0)
    answer.normal = nearest_candidate_axis(a, b, answer.normal, snap_angle);
  const double gap = support_gap(q, answer.normal);
  if (!(std::abs(gap - answer.gap) <= slack + (gap < 0 ? answer.padding : 0))) return false;
  // a distance equal to that of supporting planes needs no further proof; an overlap does
  if (gap < 0) {
    const auto exact = deepest_separation(a, b, slack);
    if (!exact || exact->core_gap - a.radius - b.radius > gap + slack) return false;
  }
  answer.gap = gap;
  return true;
}

/// Returns whether the pair has indeed no contact.
bool confirmed_apart(const ConvexCore& a, const ConvexCore& b, double tolerance) {
  const double slack = answer_tolerance * length_scale(a, b);
  return best_separating_axis(a, b).core_gap - a.radius - b.radius > tolerance - slack ||
         !deepest_separation(a, b, tolerance - slack);
}

}  // namespace

double support_gap(const Query& q, const Vec3& n) {
  const auto support = [&](const ConvexShape& shape, const Pose& pose, const Vec3& direction) {
    return pose.to_world(rigid::support(shape, pose.orientation.conjugate() * direction));
  };
  return n.dot(support(q.b, q.pose_b, -n) - support(q.a, q.pose_a, n));
}

MeshTree& EngineBackend::tree_of(const SharedMesh& mesh) {
  auto& tree = trees_[mesh];
  if (!tree) tree = make_tree(mesh);
  return *tree;
}

void EngineBackend::find_triangles(const SharedMesh& mesh, const BoundingBox& near,
                                   std::vector<std::uint32_t>& out) {
  tree_of(mesh).append_near(near, out);
}

void EngineBackend::find_triangle_pairs(const SharedMesh& a, const Pose& pose_a, const SharedMesh& b,
                                        const Pose& pose_b, double margin, std::vector<TrianglePair>& out) {
  tree_of(a).append_pairs_near(tree_of(b), pose_a, pose_b, margin, out);
}

void EngineBackend::collide(const ConvexShape& shape_a, const Pose& pose_a, const ConvexShape& shape_b,
                            const Pose& pose_b, double tolerance, std::vector<ContactPoint>& out) {
  ++counters_.queries;
  const Query q{shape_a, shape_b, pose_a, pose_b, tolerance};
  const ConvexCore a = convex_core(shape_a, pose_a);
  if (const auto* wall = std::get_if<HalfSpace>(&shape_b)) {
    check_plane(q);
    return append_plane_manifold(a, pose_b.position, pose_b.orientation * wall->normal, tolerance, out);
  }
  const ConvexCore b = convex_core(shape_b, pose_b);
  a.is_box&& b.is_box ? collide_boxes(q, a, b, out) : collide_convex(q, a, b, out);
}

void EngineBackend::collide_boxes(const Query& q, const ConvexCore& a, const ConvexCore& b,
                                  std::vector<ContactPoint>& out) {
  const double radii = a.radius + b.radius, tolerance = q.tolerance;
  for (int method = 0; method < methods(q); ++method) {
    std::optional<Answer> answer = ask(method, q);
    if (answer ? confirmed(q, a, b, *answer) : confirmed_apart(a, b, tolerance)) {
      ++counters_.answered;
      if (answer) append_box_manifold(a, b, {answer->normal, answer->gap + radii}, tolerance, out);
      return;
    }
    ++counters_.fallbacks;
  }
  if (const auto deepest = deepest_separation(a, b, tolerance))
    append_box_manifold(a, b, *deepest, tolerance, out);
}

void EngineBackend::collide_convex(const Query& q, const ConvexCore& a, const ConvexCore& b,
                                   std::vector<ContactPoint>& out) {
  const double radii = a.radius + b.radius, slack = curved_tolerance * length_scale(a, b);
  const auto append = [&](const Approach& found) { append_manifold(a, b, found, q.tolerance, out); };
  for (int method = 0; method < methods(q); ++method) {
    const std::optional<Answer> answer = ask(method, q);
    if (!answer) {
      const auto found = deepest_direction(a, b, q.tolerance + radii);
      if (!found || found->peak.core_gap - radii > q.tolerance - slack) {
        ++counters_.answered;
        if (found) append(*found);
        return;
      }
    } else if (std::abs(answer->normal.squaredNorm() - 1) < 1e-6) {
      const auto found = proven_direction(a, b, answer->normal.normalized(), q.tolerance + radii);
      if (found ? std::abs(found->peak.core_gap - radii - answer->gap) <= slack + answer->padding
                : answer->gap > q.tolerance - slack) {
        ++counters_.refined;
        if (found) append(*found);
        return;
      }
    }
    ++counters_.fallbacks;
  }
  if (const auto found = deepest_direction(a, b, q.tolerance + radii)) append(*found);
}

void EngineBackend::check_plane(const Query& q) {
  const Vec3 outward = q.pose_b.orientation * std::get<HalfSpace>(q.b).normal;
  const Vec3 furthest = support(q.a, q.pose_a.orientation.conjugate() * -outward);
  const double gap = outward.dot(q.pose_a.to_world(furthest) - q.pose_b.position);
  const double slack = answer_tolerance * (furthest.norm() + std::abs(gap));
  const std::optional<Answer> answer = ask(0, q);
  const bool right = answer ? (answer->normal + outward).norm() < 1e-9 && std::abs(answer->gap - gap) <= slack
                            : gap > q.tolerance - slack;
  if (!right) ++counters_.fallbacks;
}

}  // namespace silt::adapters
