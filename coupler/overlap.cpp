#include "coupler/overlap.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

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

void add_balls(const rigid::Cylinder&, const Pose&, std::vector<InnerBall>&) {}
void add_balls(const rigid::Ellipsoid&, const Pose&, std::vector<InnerBall>&) {}
void add_balls(const rigid::Polyhedron&, const Pose&, std::vector<InnerBall>&) {}
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
