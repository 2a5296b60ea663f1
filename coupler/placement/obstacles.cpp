#include "coupler/placement/obstacles.hpp"

#include <algorithm>

#include "coupler/case/case.hpp"
#include "coupler/placement/overlap.hpp"
#include "rigid/shapes/shape.hpp"

namespace silt::coupler {

using rigid::BoundingBox;
using rigid::Vec3;

Obstacles::Obstacles(const Case& scene, const rigid::Extent& extent, std::span<const GivenBody> given,
                     double reach)
    : scene_(scene),
      extent_(extent),
      given_(given),
      walls_(scene),
      given_grid_(extent, std::max(reach, mean_width(scene, given))) {
  for (std::size_t i = 0; i < given.size(); ++i)
    given_grid_.insert(static_cast<int>(i),
                       rigid::bounding_box(scene.shapes[given[i].spec.shape], given[i].spec.pose));
}

void Obstacles::begin_balls(double radius, double gap) {
  balls_.push_back({radius, NeighbourGrid(extent_, 2 * radius + gap), {}});
}

void Obstacles::add_ball(const Vec3& centre) {
  Balls& balls = balls_.back();
  balls.grid.insert(static_cast<int>(balls.centres.size()), {centre, centre});
  balls.centres.push_back(centre);
}

bool Obstacles::clear_of_given(const Vec3& centre, double distance) const {
  bool clear = true;
  if (!given_.empty())
    given_grid_.visit(BoundingBox::around(centre, Vec3::Constant(distance)), [&](int i) {
      const BodySpec& body = given_[i].spec;
      clear = distance_to(scene_.shapes[body.shape], body.pose, centre, extent_) >= distance;
      return clear;
    });
  return clear;
}

bool Obstacles::is_free(const Vec3& centre, double radius, double gap) const {
  if (!walls_.are_clear_of(centre, radius + gap)) return false;
  for (const Balls& balls : balls_) {
    const double distance = balls.radius + radius + gap;
    bool clear = true;
    if (balls.centres.empty()) continue;
    balls.grid.visit(BoundingBox::around(centre, Vec3::Constant(distance)), [&](int i) {
      clear = nearest_image(balls.centres[i] - centre, extent_).norm() >= distance;
      return clear;
    });
    if (!clear) return false;
  }
  return clear_of_given(centre, radius + gap);
}

}  // namespace silt::coupler
