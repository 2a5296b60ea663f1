#include "coupler/placement/obstacles.hpp"

#include <algorithm>

#include "coupler/case/case.hpp"
#include "coupler/case/case_extent.hpp"
#include "coupler/placement/overlap.hpp"
#include "rigid/collision/tube_contacts.hpp"
#include "rigid/shapes/shape.hpp"

namespace silt::coupler {

using rigid::BoundingBox;
using rigid::Vec3;

Obstacles::Obstacles(const Case& scene, const rigid::Extent& extent, std::span<const GivenBody> given,
                     double reach)
    : scene_(scene),
      extent_(extent),
      given_(given),
      given_grid_(extent, std::max(reach, mean_width(scene, given))) {
  for (const CurvedWall& wall : scene.walls)
    if (const auto* tube = wall.tube())
      walls_.push_back({{tube->radius}, rigid::pose_of(*tube)});
    else if (const auto* mesh = wall.mesh())
      meshes_.push_back({mesh->mesh, mesh->motion.pose(mesh->start, 0)});
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

bool Obstacles::clear_of_walls(const Vec3& centre, double distance) const {
  const auto clear_of_mesh = [&](const PlacedMesh& wall) {
    const Vec3 x = wall.pose.to_body(centre);
    return wall.mesh.surface->nearest(x, distance).distance >= distance && !wall.mesh.contains(x);
  };
  const auto clear_of_tube = [&](const PlacedTube& wall) {
    return rigid::gap_in_tube(rigid::Sphere{distance}, {centre, rigid::Quat::Identity()}, wall.tube,
                              wall.pose) >= 0;
  };
  return std::all_of(walls_.begin(), walls_.end(), clear_of_tube) &&
         std::all_of(meshes_.begin(), meshes_.end(), clear_of_mesh);
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
  if (!clear_of_walls(centre, radius + gap)) return false;
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
