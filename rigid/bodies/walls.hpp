#pragma once
// The walls: sides of the domain as half-spaces, and tubes. The last rows of a BodySet, the same on every
// rank.
#include <array>

#include "rigid/bodies/body_exchange.hpp"
#include "rigid/bodies/body_set.hpp"
#include "rigid/bodies/world.hpp"

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

}  // namespace silt::rigid
