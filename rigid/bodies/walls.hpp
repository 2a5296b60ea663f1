#pragma once
// The walls: sides of the domain as half-spaces, tubes and meshes. The last rows of a BodySet, the same on
// every rank.
#include <array>

#include "rigid/bodies/body_exchange.hpp"
#include "rigid/bodies/body_set.hpp"
#include "rigid/bodies/prescribed_motion.hpp"
#include "rigid/bodies/world.hpp"
#include "rigid/shapes/shape_fwd.hpp"
#include "rigid/shapes/triangle_mesh.hpp"
#include "rigid/shapes/tube.hpp"

namespace silt::rigid {

struct WallSpec {
  bool solid = false;
  int material = 0;
  Vec3 velocity = Vec3::Zero();  // of its surface, tangential: the wall slides in its own plane
};

/// Appends a row for each solid side, at 2 * axis + upper, of an axis that is not periodic, adds their shapes
/// to the world, and reindexes. Call once. std::invalid_argument for a velocity across the wall.
void add_walls(BodySet&, World&, const Extent&, const std::array<WallSpec, 6>&);

/// A tube in a solid that fills the rest of the domain. It turns about its axis: its surface stays where
/// it is.
struct TubeWallSpec {
  Tube tube{};
  Vec3 point = Vec3::Zero(), axis = Vec3::UnitZ();  // origin and z axis of the tube; axis: unit
  int material = 0;
  double angular_velocity = 0;  // about the axis, right-handed

  bool moves() const { return angular_velocity != 0; }
  Pose pose(double time = 0) const;
  PrescribedMotion::Velocity velocity_at(double) const { return {Vec3::Zero(), angular_velocity * axis}; }
};

/// A wall of triangles. What moves as prescribed, and turns about itself, is its reference point, which may
/// be far from the triangles.
struct MeshWallSpec {
  Mesh mesh;                  // about some point near it
  Pose start;                 // of the reference point at time 0
  Vec3 axis = Vec3::UnitZ();  // unit: of the quantity wall-torque, through the reference point
  int material = 0;
  PrescribedMotion motion;
  Vec3 arm = Vec3::Zero();  // from the reference point to the origin of the mesh's frame, in that frame

  bool moves() const { return motion.moves(); }
  /// Pose and velocities of the mesh's frame.
  Pose pose(double time) const;
  PrescribedMotion::Velocity velocity_at(double time) const;
  /// Returns the distance of its furthest corner from the reference point.
  double reach() const;
};

/// Appends the row of a tube or a mesh, whatever there is already, adds its shape to the world, and
/// reindexes. Its pose is that of time 0.
void add_wall(BodySet&, World&, const TubeWallSpec&);
void add_wall(BodySet&, World&, const MeshWallSpec&);
/// Gives a mesh's row the pose and the velocities of a time.
void move_wall(BodySet&, std::size_t row, const MeshWallSpec&, double time);

}  // namespace silt::rigid
