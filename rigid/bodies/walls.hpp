#pragma once
// The walls: sides of the domain as half-spaces, tubes and meshes. The last rows of a BodySet, the same on
// every rank.
#include <array>

#include "rigid/bodies/body_exchange.hpp"
#include "rigid/bodies/body_set.hpp"
#include "rigid/bodies/wall_motion.hpp"
#include "rigid/bodies/world.hpp"
#include "rigid/shapes/mesh.hpp"

namespace silt::rigid {

struct WallSpec {
  bool solid = false;
  int material = 0;
  Vec3 velocity = Vec3::Zero();  // of its surface, tangential: the wall slides in its own plane
};

/// Appends a row for each solid side, at 2 * axis + upper, of an axis that is not periodic, adds their shapes
/// to the world, and reindexes. Call once. std::invalid_argument for a velocity across the wall.
void add_walls(BodySet&, World&, const Extent&, const std::array<WallSpec, 6>&);

/// A round hole without end in a solid that fills the rest of the domain. It turns about its axis and slides
/// along it, so its surface stays where it is.
struct TubeSpec {
  double radius = 0;
  Vec3 point = Vec3::Zero(), axis = Vec3::UnitZ();  // the centre line; axis: unit
  int material = 0;
  double angular_velocity = 0;  // about the axis, right-handed
  double velocity = 0;          // along the axis
};

/// Its z axis is the tube's.
Pose pose_of(const TubeSpec&);

/// Appends the row of a tube, whatever there is already, adds its shape to the world, and reindexes.
void add_tube(BodySet&, World&, const TubeSpec&);

/// A wall of triangles. What moves as prescribed, and turns about itself, is its reference point, which may
/// be far from the triangles.
struct MeshWallSpec {
  Mesh mesh;                  // about some point near it
  Pose start;                 // of the reference point at time 0
  Vec3 axis = Vec3::UnitZ();  // unit: of the quantity wall-torque, through the reference point
  int material = 0;
  WallMotion motion;
  Vec3 arm = Vec3::Zero();  // from the reference point to the origin of the mesh's frame, in that frame

  /// Pose and velocities of the mesh's frame.
  Pose pose(double time) const;
  WallMotion::Velocity velocity(double time) const;
  /// How far its furthest corner is from the reference point.
  double reach() const;
};

/// Appends the row of a mesh, likewise. Its pose is that of time 0.
void add_mesh_wall(BodySet&, World&, const MeshWallSpec&);
/// Gives a mesh's row the pose and the velocities of a time.
void move_mesh_wall(BodySet&, std::size_t row, const MeshWallSpec&, double time);

}  // namespace silt::rigid
