#pragma once
// Walls: sides of the domain (half-spaces), tubes and meshes. The last rows of a BodySet, on every rank.
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
  bool mirrors = false;          // a plane of symmetry
  Vec3 velocity = Vec3::Zero();  // of the surface, tangential: the wall slides in its own plane
};

/// Appends a row for each solid side 2 * axis + upper of the axes that are not periodic, adds their shapes to
/// the world, and reindexes. Call once. Throws std::invalid_argument for a velocity normal to the wall.
void add_walls(BodySet&, World&, const Extent&, const std::array<WallSpec, 6>&);

/// A tube: a hole in the solid that fills the rest of the domain. It may rotate about its axis.
struct TubeWallSpec {
  Tube tube{};
  Vec3 point = Vec3::Zero(), axis = Vec3::UnitZ();  // origin and z axis (unit) of the tube
  int material = 0;
  double angular_velocity = 0;  // about the axis, right-handed

  bool moves() const { return angular_velocity != 0; }
  Pose pose(double time = 0) const;
  PrescribedMotion::Velocity velocity_at(double) const { return {Vec3::Zero(), angular_velocity * axis}; }
};

/// A wall of triangles, with the motion of its reference point, which may be far from the triangles.
struct MeshWallSpec {
  Mesh mesh;                  // in a frame with the origin near it
  Pose start;                 // of the reference point at time 0
  Vec3 axis = Vec3::UnitZ();  // unit vector through the reference point, for the quantity wall-torque
  int material = 0;
  PrescribedMotion motion;
  Vec3 arm = Vec3::Zero();  // from the reference point to the origin of the mesh's frame, in that frame

  bool moves() const { return motion.moves(); }
  /// Return pose and velocities of the mesh's frame.
  Pose pose(double time) const;
  PrescribedMotion::Velocity velocity_at(double time) const;
  /// Returns the distance of the furthest vertex from the reference point.
  double reach() const;
};

/// Appends the row of a tube or a mesh in its pose at time 0, adds its shape to the world, and reindexes.
void add_wall(BodySet&, World&, const TubeWallSpec&);
void add_wall(BodySet&, World&, const MeshWallSpec&);
/// Sets the row of a mesh to its pose and velocities at a time.
void move_wall(BodySet&, std::size_t row, const MeshWallSpec&, double time);

}  // namespace silt::rigid
