#pragma once
// The walls of the domain as half-spaces: the last rows of a BodySet, the same on every rank.
#include <array>

#include "rigid/body_exchange.hpp"
#include "rigid/body_set.hpp"
#include "rigid/world.hpp"

namespace silt::rigid {

struct WallSpec {
  bool solid = false;
  int material = 0;
  Vec3 velocity = Vec3::Zero();  // of its surface, tangential: the wall slides in its own plane
};

/// Appends a row for each solid side, at 2 * axis + upper, of an axis that is not periodic, adds their shapes
/// to the world, and reindexes. Call once. std::invalid_argument for a velocity across the wall.
void add_walls(BodySet&, World&, const Extent&, const std::array<WallSpec, 6>&);

}  // namespace silt::rigid
