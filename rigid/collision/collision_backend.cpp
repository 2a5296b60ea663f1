#include "rigid/collision/collision_backend.hpp"

#include "rigid/collision/convex_core.hpp"
#include "rigid/collision/manifold.hpp"

namespace silt::rigid {
namespace {

/// Traverses two trees simultaneously.
class PairSearch {
 public:
  PairSearch(const TriangleMesh& a, const Pose& pose_a, const TriangleMesh& b, const Pose& pose_b,
             double margin, std::vector<TrianglePair>& out)
      : a_(a), b_(b), margin_(margin), out_(out) {
    const Pose a_in_b = pose_a.relative_to(pose_b);
    turn_ = a_in_b.orientation.toRotationMatrix();
    shift_ = a_in_b.position;
  }

  void descend(std::uint32_t at_a, std::uint32_t at_b) {
    const BoxTree::Node &in_a = a_.tree().nodes()[at_a], &in_b = b_.tree().nodes()[at_b];
    const BoundingBox box = seen_from_b(box_of(in_a));
    if (!in_b.overlaps(box)) return;
    if (in_a.count > 0 && in_b.count > 0) return add_leaves(in_a, in_b);
    const bool into_a = in_b.count > 0 || (in_a.count == 0 && size_of(in_a) >= size_of(in_b));
    for (std::uint32_t child = 0; child < 2; ++child)
      into_a ? descend(in_a.first + child, at_b) : descend(at_a, in_b.first + child);
  }

 private:
  static BoundingBox box_of(const BoxTree::Node& node) {
    return {{node.lower[0], node.lower[1], node.lower[2]}, {node.upper[0], node.upper[1], node.upper[2]}};
  }
  static double size_of(const BoxTree::Node& node) {
    const BoundingBox box = box_of(node);
    return (box.upper - box.lower).maxCoeff();
  }
  static BoundingBox box_of(const TriangleMesh& mesh, std::uint32_t triangle) {
    BoundingBox box = BoundingBox::empty();
    for (const Vec3& x : mesh.corners(triangle)) box.add({x, x});
    return box;
  }
  BoundingBox seen_from_b(const BoundingBox& box) const {
    const Vec3 half = turn_.cwiseAbs() * (0.5 * (box.upper - box.lower));
    return BoundingBox::around(turn_ * (0.5 * (box.lower + box.upper)) + shift_,
                               half + Vec3::Constant(margin_));
  }
  void add_leaves(const BoxTree::Node& in_a, const BoxTree::Node& in_b) {
    for (std::uint32_t i = in_a.first; i < in_a.first + in_a.count; ++i) {
      const BoundingBox of_i = seen_from_b(box_of(a_, i));
      for (std::uint32_t j = in_b.first; j < in_b.first + in_b.count; ++j) {
        const BoundingBox of_j = box_of(b_, j);
        if (((of_i.lower - of_j.upper).array() <= 0).all() && ((of_j.lower - of_i.upper).array() <= 0).all())
          out_.push_back({i, j});
      }
    }
  }

  const TriangleMesh &a_, &b_;
  double margin_;
  std::vector<TrianglePair>& out_;
  Mat3 turn_;
  Vec3 shift_;
};

/// Two spheres, the most frequent pair, without the general path through cores.
void collide_spheres(double radius_a, const Vec3& centre_a, double radius_b, const Vec3& centre_b,
                     double tolerance, std::vector<ContactPoint>& out) {
  const Vec3 d = centre_b - centre_a;
  const double distance = d.norm(), radii = radius_a + radius_b, gap = distance - radii;
  if (gap > tolerance) return;
  // concentric to rounding: an arbitrary normal, always the same one
  const Vec3 normal = distance > 1e-13 * radii ? Vec3(d / distance) : Vec3(Vec3::UnitZ());
  const Vec3 on_a = centre_a + radius_a * normal;
  out.push_back({on_a, on_a + gap * normal, normal, gap, feature_id({}, {})});
}

}  // namespace

bool CollisionBackend::supports(const ConvexShape& a, const ConvexShape& b) const {
  return !std::holds_alternative<HalfSpace>(a) && has_codes(a) && has_codes(b);
}

void CollisionBackend::triangles_near(const SharedMesh& mesh, const BoundingBox& near,
                                      std::vector<std::uint32_t>& out) {
  ++counters_.queries;
  counters_.answered += finds_triangles();
  find_triangles(mesh, near, out);
}

void CollisionBackend::triangle_pairs_near(const SharedMesh& a, const Pose& pose_a, const SharedMesh& b,
                                           const Pose& pose_b, double margin,
                                           std::vector<TrianglePair>& out) {
  ++counters_.queries;
  counters_.answered += finds_triangles();
  find_triangle_pairs(a, pose_a, b, pose_b, margin, out);
}

void CollisionBackend::find_triangles(const SharedMesh& mesh, const BoundingBox& near,
                                      std::vector<std::uint32_t>& out) {
  mesh->for_near(near, [&](std::uint32_t t) { out.push_back(t); });
}

void CollisionBackend::find_triangle_pairs(const SharedMesh& a, const Pose& pose_a, const SharedMesh& b,
                                           const Pose& pose_b, double margin,
                                           std::vector<TrianglePair>& out) {
  PairSearch(*a, pose_a, *b, pose_b, margin, out).descend(0, 0);
}

void AnalyticBackend::collide(const ConvexShape& a, const Pose& pose_a, const ConvexShape& b,
                              const Pose& pose_b, double tolerance, std::vector<ContactPoint>& out) {
  ++counters_.queries;
  if (const auto* sphere_a = std::get_if<Sphere>(&a), *sphere_b = std::get_if<Sphere>(&b);
      sphere_a && sphere_b)
    return collide_spheres(sphere_a->radius, pose_a.position, sphere_b->radius, pose_b.position, tolerance,
                           out);
  const ConvexCore core_a = convex_core(a, pose_a);
  if (const auto* wall = std::get_if<HalfSpace>(&b))
    return append_plane_manifold(core_a, pose_b.position, pose_b.orientation * wall->normal, tolerance, out);
  const ConvexCore core_b = convex_core(b, pose_b);
  if (const auto found = nearest_approach(core_a, core_b, tolerance))
    append_manifold(core_a, core_b, *found, tolerance, out);
}

}  // namespace silt::rigid
