#include "coupler/case/overlap.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

namespace silt::coupler {
namespace {

using rigid::Extent;
using rigid::Pose;
using rigid::Shape;
using rigid::Vec3;

constexpr double none = -std::numeric_limits<double>::infinity();

void add_balls(const rigid::Sphere& sphere, const Pose& pose, std::vector<InnerBall>& out) {
  out.push_back({pose.position, sphere.radius});
}

void add_balls(const rigid::Capsule& capsule, const Pose& pose, std::vector<InnerBall>& out) {
  constexpr int most = 64;  // balls half a radius apart, for a capsule up to 32 radii long
  const int gaps = std::clamp(static_cast<int>(std::ceil(4 * capsule.half_length / capsule.radius)), 1, most);
  for (int i = 0; i <= gaps; ++i)
    out.push_back({pose.to_world({0, 0, capsule.half_length * (2. * i / gaps - 1)}), capsule.radius});
}

void add_balls(const rigid::Box& box, const Pose& pose, std::vector<InnerBall>& out) {
  constexpr int points = 5;  // along an edge
  out.push_back({pose.position, box.half_edges.minCoeff()});
  for (int i = 0; i < points; ++i)
    for (int j = 0; j < points; ++j)
      for (int k = 0; k < points; ++k) {
        const bool on_face = i % (points - 1) == 0 || j % (points - 1) == 0 || k % (points - 1) == 0;
        const Vec3 corner = Vec3(i, j, k) * (2. / (points - 1)) - Vec3::Ones();
        if (on_face) out.push_back({pose.to_world(box.half_edges.cwiseProduct(corner)), 0});
      }
}

void add_balls(const rigid::Cylinder& cylinder, const Pose& pose, std::vector<InnerBall>& out) {
  constexpr int most = 64, points = 12;
  const double r = std::min(cylinder.radius, cylinder.half_length), free = cylinder.half_length - r;
  const int gaps = std::clamp(static_cast<int>(std::ceil(4 * free / r)), 1, most);
  for (int i = 0; i <= gaps; ++i) out.push_back({pose.to_world({0, 0, free * (2. * i / gaps - 1)}), r});
  for (const double z : {-cylinder.half_length, cylinder.half_length}) {
    out.push_back({pose.to_world({0, 0, z}), 0});
    for (int k = 0; k < points; ++k) {
      const double angle = 2 * std::numbers::pi * k / points;
      for (const double r_k : {0.5 * cylinder.radius, cylinder.radius})
        out.push_back({pose.to_world({r_k * std::cos(angle), r_k * std::sin(angle), z}), 0});
    }
  }
}

void add_balls(const rigid::Ellipsoid& ellipsoid, const Pose& pose, std::vector<InnerBall>& out) {
  constexpr int points = 5;  // along the edges of a cube, drawn onto the surface
  out.push_back({pose.position, ellipsoid.half_axes.minCoeff()});
  for (int i = 0; i < points; ++i)
    for (int j = 0; j < points; ++j)
      for (int k = 0; k < points; ++k) {
        const Vec3 at = Vec3(i, j, k) * (2. / (points - 1)) - Vec3::Ones();
        if (at.cwiseAbs().maxCoeff() == 1)
          out.push_back({pose.to_world(ellipsoid.half_axes.cwiseProduct(at.normalized())), 0});
      }
}

void add_balls(const rigid::Polyhedron& polyhedron, const Pose& pose, std::vector<InnerBall>& out) {
  const rigid::PolyhedronMesh& mesh = *polyhedron.mesh;
  const auto middle = [&](const auto& corners) {
    Vec3 mean = Vec3::Zero();
    for (const int c : corners) mean += mesh.vertices[c] / static_cast<double>(corners.size());
    return mean;
  };
  Vec3 centre = Vec3::Zero();
  for (const Vec3& v : mesh.vertices) centre += v / static_cast<double>(mesh.vertices.size());
  out.push_back({pose.to_world(centre), std::max(0.0, -rigid::signed_distance(mesh, centre))});
  for (const Vec3& v : mesh.vertices) out.push_back({pose.to_world(v), 0});
  for (const auto& edge : mesh.edges) out.push_back({pose.to_world(middle(edge.corners)), 0});
  for (const auto& face : mesh.faces) out.push_back({pose.to_world(middle(face.corners)), 0});
}

void add_balls(const rigid::HalfSpace&, const Pose&, std::vector<InnerBall>&) {}

// How far the balls of a reach into b.
double depth_into(const Shape& a, const Pose& pose_a, const Shape& b, const Pose& pose_b) {
  double depth = none;
  for (const InnerBall& ball : inner_balls(a)) {
    const Vec3 x_B = pose_b.to_body(pose_a.to_world(ball.centre));
    depth = std::max(depth, ball.radius - rigid::signed_distance(b, x_B));
  }
  return depth;
}

// Calls f(shift) for no shift and for one period to either side along the periodic axes.
template <class F>
void for_images(const Extent& extent, F&& f) {
  std::array<int, 3> reach{};
  for (int d = 0; d < 3; ++d) reach[d] = extent.periodic[d];
  for (int i = -reach[0]; i <= reach[0]; ++i)
    for (int j = -reach[1]; j <= reach[1]; ++j)
      for (int k = -reach[2]; k <= reach[2]; ++k) f(Vec3(i, j, k).cwiseProduct(extent.size));
}

}  // namespace

std::vector<InnerBall> inner_balls(const Shape& shape) {
  std::vector<InnerBall> balls;
  for (const rigid::Part& part : rigid::convex_parts(shape))
    std::visit([&](const auto& convex) { add_balls(convex, part.pose, balls); }, part.shape);
  return balls;
}

double overlap_depth(const Shape& a, const Pose& pose_a, const Shape& b, const Pose& pose_b) {
  return std::max(depth_into(a, pose_a, b, pose_b), depth_into(b, pose_b, a, pose_a));
}

double overlap_depth(const Shape& a, const Pose& pose_a, const Shape& b, const Pose& pose_b,
                     const Extent& extent) {
  const double reach = rigid::bounding_radius(a) + rigid::bounding_radius(b);
  double depth = none;
  for_images(extent, [&](const Vec3& shift) {
    const Pose image{pose_b.position + shift, pose_b.orientation};
    if ((image.position - pose_a.position).norm() < reach)
      depth = std::max(depth, overlap_depth(a, pose_a, b, image));
  });
  return depth;
}

double distance_to(const Shape& shape, const Pose& pose, const Vec3& x_W, const Extent& extent) {
  double distance = std::numeric_limits<double>::infinity();
  for_images(extent, [&](const Vec3& shift) {
    distance = std::min(distance, rigid::signed_distance(shape, pose.to_body(x_W - shift)));
  });
  return distance;
}

}  // namespace silt::coupler
