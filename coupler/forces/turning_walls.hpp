#pragma once
// Momentum of the cells of rotating walls, in the form `exact` of the force (method-coupling.md, equation
// 38a). To avoid jolts, covered and uncovered cells give only momentum relative to the wall's motion
// (take_cell in flow.cpp); this file gives the mean of the rest.
#include <unordered_map>
#include <vector>

#include "rigid/bodies/body_set.hpp"
#include "rigid/bodies/world.hpp"
#include "rigid/shapes/mass_properties.hpp"

namespace silt::coupler {

class TurningWalls {
 public:
  /// An impulse on a wall, with the arm from the origin of its frame; lattice units, world frame.
  struct Impulse {
    rigid::BodyId wall;
    rigid::Vec3 momentum, arm;
  };
  /// Keeps a reference to the world.
  explicit TurningWalls(const rigid::World& world) : world_(world) {}
  /// Returns the momentum that the cells of mesh walls gain in a step by the walls' velocities.
  std::vector<Impulse> impulses(const rigid::BodySet&);

 private:
  const rigid::MassProperties& solid_of(std::int32_t shape);

  const rigid::World& world_;
  std::unordered_map<std::int32_t, rigid::MassProperties> solids_;  // by shape, for unit density
};

}  // namespace silt::coupler
