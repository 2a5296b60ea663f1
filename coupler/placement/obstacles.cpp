#include "coupler/placement/obstacles.hpp"

#include <algorithm>

#include "coupler/case/case.hpp"
#include "coupler/placement/overlap.hpp"
#include "rigid/shapes/shape.hpp"

namespace silt::coupler {

using rigid::BoundingBox;
using rigid::Vec3;

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
          return nearest_image(balls.centres[i] - centre, extent_).norm();
        }))
      return false;
  return given_.empty() || all_beyond(given_grid_, radius + gap, [&](int i) {
           const BodySpec& body = given_[i].spec;
           return distance_to(setup_.shapes[body.shape], body.pose, centre, extent_);
         });
}

}  // namespace silt::coupler
