#include "rigid/bodies/walls.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

#include "rigid/math/rotation_between.hpp"
#include "rigid/shapes/shape.hpp"

namespace silt::rigid {

void add_walls(BodySet& bodies, World& world, const Extent& extent, const std::array<WallSpec, 6>& specs) {
  for (int side = 0; side < 6; ++side) {
    const int axis = side / 2;
    const bool upper = side % 2 != 0;
    const WallSpec& spec = specs[side];
    if (!spec.solid || extent.periodic[axis]) continue;
    if (spec.velocity[axis] != 0) throw std::invalid_argument("a wall can only slide in its own plane");
    world.shapes.push_back(HalfSpace{Vec3::Unit(axis) * (upper ? -1.0 : 1.0)});
    world.bounding_radii.push_back(std::numeric_limits<double>::infinity());
    BodyRecord wall;
    wall.id = first_wall_id + side;
    wall.shape = static_cast<std::int32_t>(world.shapes.size()) - 1;
    wall.material = spec.material;
    wall.kind = -1;
    wall.motion = spec.velocity.isZero(0) ? Motion::fixed : Motion::prescribed;
    wall.position[axis] = upper ? extent.size[axis] : 0.0;
    Eigen::Map<Vec3>{wall.velocity} = spec.velocity;
    bodies.insert(bodies.size(), wall);
    ++bodies.walls;
  }
  bodies.reindex();
}

Pose pose_of(const TubeSpec& spec) {
  return {spec.point, rotation_between(Vec3::UnitZ(), spec.axis)};
}

namespace {

/// The row of a wall after all others, of the shape that was added last.
void add_row(BodySet& bodies, const World& world, BodyRecord wall) {
  const BodyId last = bodies.walls > 0 ? bodies.id.back() : first_wall_id;
  wall.id = std::max(last + 1, first_tube_id);
  wall.shape = static_cast<std::int32_t>(world.shapes.size()) - 1;
  wall.kind = -1;
  bodies.insert(bodies.size(), wall);
  ++bodies.walls;
  bodies.reindex();
}

void set_pose(BodyRecord& wall, const Pose& pose) {
  const Quat& q = pose.orientation;
  Eigen::Map<Vec3>{wall.position} = pose.position;
  Eigen::Map<Eigen::Vector4d>{wall.orientation} = Eigen::Vector4d(q.w(), q.x(), q.y(), q.z());
}

}  // namespace

void add_tube(BodySet& bodies, World& world, const TubeSpec& spec) {
  world.shapes.push_back(Tube{spec.radius});
  world.bounding_radii.push_back(std::numeric_limits<double>::infinity());
  BodyRecord wall;
  wall.material = spec.material;
  const bool moves = spec.angular_velocity != 0 || spec.velocity != 0;
  wall.motion = moves ? Motion::prescribed : Motion::fixed;
  set_pose(wall, pose_of(spec));
  Eigen::Map<Vec3>{wall.velocity} = spec.velocity * spec.axis;
  Eigen::Map<Vec3>{wall.angular_velocity} = spec.angular_velocity * spec.axis;
  add_row(bodies, world, wall);
}

void add_mesh_wall(BodySet& bodies, World& world, const MeshWallSpec& spec) {
  world.shapes.push_back(spec.mesh);
  world.bounding_radii.push_back(spec.mesh.bounding_radius());
  BodyRecord wall;
  wall.material = spec.material;
  wall.motion = spec.motion.moves() ? Motion::prescribed : Motion::fixed;
  add_row(bodies, world, wall);
  move_mesh_wall(bodies, bodies.size() - 1, spec, 0);
}

void move_mesh_wall(BodySet& bodies, std::size_t row, const MeshWallSpec& spec, double time) {
  const WallMotion::Velocity velocity = spec.velocity(time);
  bodies.set_pose(row, spec.pose(time));
  bodies.set_velocity(row, velocity.linear, velocity.angular);
}

Pose MeshWallSpec::pose(double time) const {
  const Pose reference = motion.pose(start, time);
  return {reference.to_world(arm), reference.orientation};
}

WallMotion::Velocity MeshWallSpec::velocity(double time) const {
  WallMotion::Velocity at = motion.velocity_at(time);
  if (!at.angular.isZero(0)) at.linear += at.angular.cross(motion.pose(start, time).orientation * arm);
  return at;
}

double MeshWallSpec::reach() const {
  double square = 0;
  for (const Vec3& corner : mesh.surface->vertices()) square = std::max(square, (arm + corner).squaredNorm());
  return std::sqrt(square);
}

}  // namespace silt::rigid
