#include "rigid/bodies/walls.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "rigid/math/types.hpp"
#include "rigid/shapes/shape.hpp"

namespace silt::rigid {

namespace {

/// Adds the shape to the world and appends the wall's row.
void append(BodySet& bodies, World& world, const Shape& shape, int material, BodyRecord& wall) {
  world.shapes.push_back(shape);
  world.bounding_radii.push_back(bounding_radius(shape));
  wall.shape = static_cast<std::int32_t>(world.shapes.size()) - 1;
  wall.material = material;
  wall.kind = -1;
  bodies.insert(bodies.size(), wall);
  ++bodies.walls;
}

/// Appends the row of a tube or a mesh.
template <class Spec>
void append(BodySet& bodies, World& world, const Shape& shape, const Spec& spec) {
  BodyRecord wall;
  wall.id = std::max(bodies.walls > 0 ? bodies.id.back() + 1 : first_tube_id, first_tube_id);
  wall.motion = spec.moves() ? Motion::prescribed : Motion::fixed;
  const Pose pose = spec.pose(0);
  const Quat& q = pose.orientation;
  const PrescribedMotion::Velocity velocity = spec.velocity_at(0);
  Eigen::Map<Vec3>{wall.position} = pose.position;
  Eigen::Map<Eigen::Vector4d>{wall.orientation} = Eigen::Vector4d(q.w(), q.x(), q.y(), q.z());
  Eigen::Map<Vec3>{wall.velocity} = velocity.linear;
  Eigen::Map<Vec3>{wall.angular_velocity} = velocity.angular;
  append(bodies, world, shape, spec.material, wall);
  bodies.reindex();
}

}  // namespace

void add_walls(BodySet& bodies, World& world, const Extent& extent, const std::array<WallSpec, 6>& specs) {
  for (int side = 0; side < 6; ++side) {
    const int axis = side / 2;
    const bool upper = side % 2 != 0;
    const WallSpec& spec = specs[side];
    if (!spec.solid || extent.periodic[axis]) continue;
    if (spec.velocity[axis] != 0) throw std::invalid_argument("a wall can only slide in its own plane");
    BodyRecord wall;
    wall.id = first_wall_id + side;
    wall.motion = spec.velocity.isZero(0) ? Motion::fixed : Motion::prescribed;
    wall.position[axis] = upper ? extent.size[axis] : 0.0;
    Eigen::Map<Vec3>{wall.velocity} = spec.velocity;
    append(bodies, world, HalfSpace{Vec3::Unit(axis) * (upper ? -1.0 : 1.0), spec.mirrors}, spec.material,
           wall);
  }
  bodies.reindex();
}

void add_wall(BodySet& bodies, World& world, const TubeWallSpec& spec) {
  append(bodies, world, spec.tube, spec);
}

void add_wall(BodySet& bodies, World& world, const MeshWallSpec& spec) {
  append(bodies, world, spec.mesh, spec);
  move_wall(bodies, bodies.size() - 1, spec, 0);
}

void move_wall(BodySet& bodies, std::size_t row, const MeshWallSpec& spec, double time) {
  const PrescribedMotion::Velocity velocity = spec.velocity_at(time);
  bodies.set_pose(row, spec.pose(time));
  bodies.set_velocity(row, velocity.linear, velocity.angular);
}

Pose TubeWallSpec::pose(double) const {
  return {point, rotation_between(Vec3::UnitZ(), axis)};
}

Pose MeshWallSpec::pose(double time) const {
  const Pose reference = motion.pose(start, time);
  return {reference.to_world(arm), reference.orientation};
}

PrescribedMotion::Velocity MeshWallSpec::velocity_at(double time) const {
  PrescribedMotion::Velocity at = motion.velocity_at(time);
  if (!at.angular.isZero(0)) at.linear += at.angular.cross(motion.pose(start, time).orientation * arm);
  return at;
}

double MeshWallSpec::reach() const {
  double square = 0;
  for (const Vec3& corner : mesh.surface->vertices()) square = std::max(square, (arm + corner).squaredNorm());
  return std::sqrt(square);
}

}  // namespace silt::rigid
