#pragma once
// What a wall that turns owes its cells, in the form `exact` of the force (method-coupling.md, equation 38a).
// The cells that it covers and leaves would give it their momentum in jolts, so they give it only what their
// fluid has beyond the wall's own motion (take_cell in flow.cpp). Of the wall's own motion this file gives
// the mean.
#include <unordered_map>
#include <vector>

#include "rigid/bodies/body_set.hpp"
#include "rigid/bodies/world.hpp"
#include "rigid/shapes/mass_properties.hpp"

namespace silt::coupler {

class TurningWalls {
 public:
  /// On a wall, at an arm from the origin of its frame; lattice units, world frame.
  struct Impulse {
    rigid::BodyId wall;
    rigid::Vec3 momentum, arm;
  };
  /// Keeps a reference to the world.
  explicit TurningWalls(const rigid::World& world) : world_(world) {}
  /// Returns the momentum that the cells of walls of triangles gain in a step with the walls' velocities.
  std::vector<Impulse> impulses(const rigid::BodySet&);

 private:
  const rigid::MassProperties& solid_of(std::int32_t shape);

  const rigid::World& world_;
  std::unordered_map<std::int32_t, rigid::MassProperties> solids_;  // by shape, of unit density
};

}  // namespace silt::coupler
