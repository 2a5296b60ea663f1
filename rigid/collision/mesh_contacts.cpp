#include "rigid/collision/mesh_contacts.hpp"

#include <algorithm>

#include "rigid/collision/manifold.hpp"
#include "rigid/shapes/shape.hpp"

namespace silt::rigid {
namespace {

/// Cosine above which normals count as equal.
constexpr double same_way = 0.95;

/// A total order of points, so that the order in which a backend returns triangles has no influence.
bool is_before(const ContactPoint& p, const ContactPoint& q) {
  if (p.feature != q.feature || p.gap != q.gap)
    return std::tie(p.feature, p.gap) < std::tie(q.feature, q.gap);
  const auto differs = [](const Vec3& x, const Vec3& y) { return x != y; };
  const auto less = [](const Vec3& x, const Vec3& y) {
    return std::lexicographical_compare(x.data(), x.data() + 3, y.data(), y.data() + 3);
  };
  return differs(p.normal, q.normal) ? less(p.normal, q.normal) : less(p.on_a, q.on_a);
}

/// Keeps the deepest point of each feature, and of points with nearly equal normals only a few.
void reduce(std::vector<ContactPoint>& points) {
  std::sort(points.begin(), points.end(), is_before);
  const auto same = [](const ContactPoint& p, const ContactPoint& q) { return p.feature == q.feature; };
  points.erase(std::unique(points.begin(), points.end(), same), points.end());
  if (points.size() <= most_contact_points) return;
  std::vector<ContactPoint> kept, group;
  while (!points.empty()) {
    const ContactPoint deepest =
        *std::ranges::min_element(points, [](const auto& p, const auto& q) { return p.gap < q.gap; });
    const auto rest = std::stable_partition(points.begin(), points.end(), [&](const ContactPoint& p) {
      return p.normal.dot(deepest.normal) >= same_way;
    });
    group.assign(points.begin(), rest);
    points.erase(points.begin(), rest);
    reduce_manifold(group);
    kept.insert(kept.end(), group.begin(), group.end());
  }
  std::sort(kept.begin(), kept.end(), is_before);
  points.swap(kept);
}

/// Reduces the points and transforms them from the frame of the query to that of the call.
void finish(std::vector<ContactPoint>& points, const Pose& frame, std::vector<ContactPoint>& out) {
  reduce(points);
  const Mat3 turn = frame.orientation.toRotationMatrix();
  for (ContactPoint& p : points) {
    p.on_a = frame.position + turn * p.on_a;
    p.on_b = frame.position + turn * p.on_b;
    p.normal = turn * p.normal;
    out.push_back(p);
  }
}

/// Handles a body whose centre is inside the solid.
void append_deep(const ConvexShape& body, const Pose& pose, const MeshFeatures& mesh, double tolerance,
                 std::vector<ContactPoint>& out) {
  const TriangleMesh::Nearest nearest = mesh.surface().nearest(pose.position);
  const Vec3 up = nearest.point - pose.position;
  const Vec3 outward = nearest.distance > 0 ? Vec3(up / nearest.distance) : mesh.normal(nearest.triangle);
  append_on_plane(convex_core(body, pose), nearest.point, outward, mesh.code_of_facet(nearest.triangle),
                  tolerance, out);
}

Vec3 middle_of(const BoxTree::Node& node) {
  return 0.5 *
         Vec3(node.lower[0] + node.upper[0], node.lower[1] + node.upper[1], node.lower[2] + node.upper[2]);
}
Vec3 half_of(const BoxTree::Node& node) {
  return 0.5 *
         Vec3(node.upper[0] - node.lower[0], node.upper[1] - node.lower[1], node.upper[2] - node.lower[2]);
}

/// Calls use(corner) for the vertices of triangles whose box may be within the tolerance.
template <class Bound, class Use>
void for_corners(const MeshFeatures& mesh, const Bound& gap_of_box, double tolerance, Use&& use) {
  thread_local std::vector<std::uint32_t> corners;
  corners.clear();
  const auto bound = [&](const BoxTree::Node& node) { return gap_of_box(middle_of(node), half_of(node)); };
  mesh.surface().tree().search(bound, tolerance, [&](std::uint32_t t) {
    for (const std::uint32_t v : mesh.surface().triangles()[t])
      if (mesh.is_corner(v)) corners.push_back(v);
  });
  std::sort(corners.begin(), corners.end());
  corners.erase(std::unique(corners.begin(), corners.end()), corners.end());
  for (const std::uint32_t v : corners) use(v);
}

}  // namespace

void append_mesh_contacts(const ConvexAt& part, const MeshAt& at, double tolerance, CollisionBackend& backend,
                          std::vector<ContactPoint>& out) {
  const MeshFeatures& mesh = at.mesh;
  const Pose pose = part.pose.relative_to(at.pose);
  BoundingBox box = std::visit([&](const auto& s) { return s.bounding_box(pose); }, part.shape);
  const double reach = std::max(tolerance, deep_behind_faces(part.shape));
  box.lower.array() -= reach;
  box.upper.array() += reach;
  thread_local std::vector<std::uint32_t> near;
  thread_local std::vector<ContactPoint> points;
  near.clear();
  points.clear();
  backend.triangles_near(mesh.mesh().surface, box, near);
  if (near.empty()) return;
  std::sort(near.begin(), near.end());
  const auto* const ball = std::get_if<Sphere>(&part.shape);
  if (ball) {
    append_ball_contacts(pose.position, ball->radius, mesh, near, tolerance, points);
  } else if (mesh.mesh().contains(pose.position)) {
    append_deep(part.shape, pose, mesh, tolerance, points);
  } else if (part.surface) {
    thread_local std::vector<TrianglePair> pairs;
    pairs.clear();
    backend.triangle_pairs_near(part.surface->mesh().surface, pose, mesh.mesh().surface, Pose{},
                                std::max(tolerance, deepest(*part.surface, mesh)), pairs);
    append_mesh_on_mesh(*part.surface, pose, mesh, pairs, tolerance, points);
  } else {
    append_curved_on_mesh(part.shape, pose, mesh, near, tolerance, points);
  }
  if (points.empty() && !ball) append_overlap(part.shape, pose, mesh, near, points);
  finish(points, at.pose, out);
}

void append_mesh_contacts(const MeshAt& a, const MeshAt& b, double tolerance, CollisionBackend& backend,
                          std::vector<ContactPoint>& out) {
  thread_local std::vector<TrianglePair> pairs;
  thread_local std::vector<ContactPoint> points;
  pairs.clear();
  points.clear();
  const Pose pose = a.pose.relative_to(b.pose);
  backend.triangle_pairs_near(a.mesh.mesh().surface, pose, b.mesh.mesh().surface, Pose{},
                              std::max(tolerance, deepest(a.mesh, b.mesh)), pairs);
  append_mesh_on_mesh(a.mesh, pose, b.mesh, pairs, tolerance, points);
  finish(points, b.pose, out);
}

void append_mesh_contacts(const MeshAt& at, const HalfSpace& wall, const Pose& pose_of_plane,
                          double tolerance, std::vector<ContactPoint>& out) {
  const auto& [mesh, pose] = at;
  const Pose seen = pose_of_plane.relative_to(pose);
  const Vec3 outward = seen.orientation * wall.normal;
  const auto gap_of = [&](const Vec3& x) { return outward.dot(x - seen.position); };
  thread_local std::vector<ContactPoint> points;
  points.clear();
  const auto lowest = [&](const Vec3& middle, const Vec3& half) {
    return gap_of(middle) - half.dot(outward.cwiseAbs());
  };
  for_corners(mesh, lowest, tolerance, [&](std::uint32_t v) {
    const Vec3& x = mesh.corner(v);
    const double gap = gap_of(x);
    if (gap <= tolerance) points.push_back({x, x - gap * outward, -outward, gap, mesh.code_of_corner(v)});
  });
  finish(points, pose, out);
}

void append_mesh_contacts(const MeshAt& at, const Tube& wall, const Pose& pose_of_wall, double tolerance,
                          std::vector<ContactPoint>& out) {
  const auto& [mesh, pose] = at;
  const Pose seen = pose_of_wall.relative_to(pose);
  thread_local std::vector<ContactPoint> points;
  points.clear();
  const auto least = [&](const Vec3& middle, const Vec3& half) {
    return wall.gap(seen, middle) - half.norm();
  };
  for_corners(mesh, least, tolerance, [&](std::uint32_t v) {
    const Vec3& x = mesh.corner(v);
    const double gap = wall.gap(seen, x);
    if (gap > tolerance) return;
    const Vec3 normal = wall.outward(seen, x);
    points.push_back({x, x + gap * normal, normal, gap, mesh.code_of_corner(v)});
  });
  finish(points, pose, out);
}

}  // namespace silt::rigid
