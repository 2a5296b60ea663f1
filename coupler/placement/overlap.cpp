#include "coupler/placement/overlap.hpp"

#include <algorithm>
#include <limits>

#include "rigid/shapes/shape.hpp"

namespace silt::coupler {
namespace {

using rigid::Extent;
using rigid::Pose;
using rigid::Shape;
using rigid::Vec3;

constexpr double no_overlap = -std::numeric_limits<double>::infinity();

// How far the balls of a reach into b.
double depth_into(const Shape& a, const Pose& pose_a, const Shape& b, const Pose& pose_b) {
  double depth = no_overlap;
  for (const rigid::InnerBall& ball : rigid::inner_balls(a)) {
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

double overlap_depth(const Shape& a, const Pose& pose_a, const Shape& b, const Pose& pose_b) {
  return std::max(depth_into(a, pose_a, b, pose_b), depth_into(b, pose_b, a, pose_a));
}

double overlap_depth(const Shape& a, const Pose& pose_a, const Shape& b, const Pose& pose_b,
                     const Extent& extent) {
  const double reach = rigid::bounding_radius(a) + rigid::bounding_radius(b);
  double depth = no_overlap;
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
