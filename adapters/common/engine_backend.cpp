#include "adapters/common/engine_backend.hpp"

#include <algorithm>
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

using rigid::Image;
using rigid::Vec3;

namespace {

/// Distance that a body may move before its leaf does, relative to its reach. More gives more pairs to test.
constexpr double slack = 0.05;
/// Relative rounding of coordinates, by which cubes are enlarged so that no pair that meets is missed.
constexpr double rounding = 1e-14;

struct Bounds {
  Vec3 lower = Vec3::Constant(1e300), upper = Vec3::Constant(-1e300);

  template <class Cube>
  void add(const Cube& c) {
    lower = lower.cwiseMin(c.centre - Vec3::Constant(c.half_edge));
    upper = upper.cwiseMax(c.centre + Vec3::Constant(c.half_edge));
  }
  template <class Cube>
  bool overlap(const Cube& c) const {
    return ((c.centre.array() + c.half_edge) >= lower.array()).all() &&
           ((c.centre.array() - c.half_edge) <= upper.array()).all();
  }
};

}  // namespace

TreeBroadPhase::Leaf TreeBroadPhase::leaf_of(rigid::BodyId id, std::size_t row) {
  if (row < by_row_.size() && leaves_[by_row_[row]].id == id) return by_row_[row];
  const auto [at, is_new] = by_id_.try_emplace(id, 0);
  if (!is_new) return at->second;
  if (free_.empty()) {
    free_.push_back(static_cast<Leaf>(leaves_.size()));
    leaves_.emplace_back();
  }
  at->second = free_.back();
  free_.pop_back();
  leaves_[at->second] = {id, row, {}, 0};
  return at->second;
}

/// Updates the leaves to the present bodies and their positions.
void TreeBroadPhase::update_leaves(const rigid::Surroundings& around) {
  ++step_;
  reach_.resize(around.size());
  std::vector<Leaf> by_row(around.size());
  for (std::size_t row = 0; row < around.size(); ++row) {
    const Vec3& x = around.bodies.position[row];
    const double tight = around.reach[row].sum();
    const double half_edge =
        tight + rounding * (tight + x.lpNorm<Eigen::Infinity>() + around.extent.size.maxCoeff());
    reach_[row] = {x, half_edge};
    by_row[row] = leaf_of(around.bodies.id[row], row);
    Known& leaf = leaves_[by_row[row]];
    leaf.row = row;
    const double spare = leaf.cube.half_edge - half_edge;
    if (leaf.seen == 0 || (x - leaf.cube.centre).lpNorm<Eigen::Infinity>() > spare ||
        spare > 4 * slack * half_edge) {
      leaf.cube = {x, (1 + slack) * half_edge};
      place(by_row[row], leaf.cube);
    }
    leaf.seen = step_;
  }
  by_row_ = std::move(by_row);
}

void TreeBroadPhase::remove_absent() {
  if (by_id_.size() == by_row_.size()) return;
  for (Leaf k = 0; k < leaves_.size(); ++k) {
    Known& leaf = leaves_[k];
    if (leaf.seen == 0 || leaf.seen == step_) continue;
    remove(k);
    by_id_.erase(leaf.id);
    free_.push_back(k);
    leaf.seen = 0;
  }
}

void TreeBroadPhase::find_images(const rigid::Surroundings& around,
                                 std::vector<rigid::CandidatePair>& found) {
  // opposite images give the same pairs as seen from either body: half of the images suffice
  std::vector<Image> images = rigid::images_of(around.extent);
  std::erase_if(images, [](Image image) { return image <= Image{}; });
  if (images.empty()) return;
  Bounds all;
  for (const Leaf k : by_row_) all.add(leaves_[k].cube);
  for (std::size_t row = 0; row < around.size(); ++row)
    for (const Image image : images) {
      const Cube shifted{reach_[row].centre - around.extent.shift(image), reach_[row].half_edge};
      if (!all.overlap(shifted)) continue;
      hits_.clear();
      overlapping(shifted, hits_);
      for (const Leaf k : hits_) {
        if (leaves_[k].row == row) continue;
        const rigid::CandidatePair pair = around.in_order(row, leaves_[k].row, image);
        if (around.meet(pair)) found.push_back(pair);
      }
    }
}

void TreeBroadPhase::find_pairs(const rigid::Surroundings& around, std::vector<rigid::CandidatePair>& found) {
  update_leaves(around);
  remove_absent();
  refresh();
  pairs_.clear();
  overlapping_pairs(pairs_);
  for (const auto& [p, q] : pairs_) {
    const rigid::CandidatePair pair = around.in_order(leaves_[p].row, leaves_[q].row, {});
    if (around.meet(pair)) found.push_back(pair);
  }
  find_images(around, found);
}

}  // namespace silt::adapters
