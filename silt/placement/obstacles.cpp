#include "silt/placement/obstacles.hpp"

#include <algorithm>
#include <limits>

#include "rigid/shapes/shape.hpp"
#include "silt/case/case.hpp"

namespace silt {
namespace {

using rigid::Extent;
using rigid::Pose;
using rigid::Shape;
using rigid::Vec3;

constexpr double no_overlap = -std::numeric_limits<double>::infinity();

// Returns how far the spheres of a reach into b.
double depth_into(const Shape& a, const Pose& pose_a, const Shape& b, const Pose& pose_b) {
  double depth = no_overlap;
  for (const rigid::InnerBall& ball : rigid::inner_balls(a)) {
    const Vec3 x_B = pose_b.to_body(pose_a.to_world(ball.centre));
    depth = std::max(depth, ball.radius - rigid::signed_distance(b, x_B));
  }
  return depth;
}

// Calls f(shift) for no shift and for shifts by one period along periodic axes.
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

using rigid::BoundingBox;

Obstacles::Obstacles(const Case& setup, const rigid::Extent& extent, std::span<const GivenBody> given,
                     double reach)
    : setup_(setup),
      extent_(extent),
      given_(given),
      walls_(setup),
      given_grid_(extent, std::max(reach, mean_width(setup, given))) {
  for (std::size_t i = 0; i < given.size(); ++i)
    given_grid_.insert(static_cast<int>(i),
                       rigid::bounding_box(setup.shapes[given[i].spec.shape], given[i].spec.pose));
}

void Obstacles::begin_balls(double radius, double gap) {
  balls_.push_back({radius, NeighbourGrid(extent_, 2 * radius + gap), {}});
}

void Obstacles::add_ball(const Vec3& centre) {
  Balls& balls = balls_.back();
  balls.grid.insert(static_cast<int>(balls.centres.size()), {centre, centre});
  balls.centres.push_back(centre);
}

bool Obstacles::is_free(const Vec3& centre, double radius, double gap) const {
  if (!walls_.are_clear_of(centre, radius + gap)) return false;
  const auto all_beyond = [&](const NeighbourGrid& grid, double distance, auto&& distance_of) {
    bool clear = true;
    grid.visit(BoundingBox::around(centre, Vec3::Constant(distance)),
               [&](int i) { return clear = distance_of(i) >= distance; });
    return clear;
  };
  for (const Balls& balls : balls_)
    if (!balls.centres.empty() && !all_beyond(balls.grid, balls.radius + radius + gap, [&](int i) {
          return coupler::nearest_image(balls.centres[i] - centre, extent_).norm();
        }))
      return false;
  return given_.empty() || all_beyond(given_grid_, radius + gap, [&](int i) {
           const BodySpec& body = given_[i].spec;
           return distance_to(setup_.shapes[body.shape], body.pose, centre, extent_);
         });
}

}  // namespace silt
