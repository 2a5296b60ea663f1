#pragma once
// What all ranks know alike about the bodies.
#include <memory>
#include <optional>
#include <vector>

#include "rigid/bodies/lubrication.hpp"
#include "rigid/shapes/shape_fwd.hpp"

namespace silt::rigid {

struct Material {
  double restitution = 0, friction = 0;
};

/// A body whose surface moves no faster than `speed` for `steps` steps is held at rest until forces out of
/// balance would have given it twice that speed in as many, or something hits it.
struct SleepRule {
  double speed;  // lattice units
  int steps;
};

/// What all ranks know alike: shapes, materials and laws. Tables of pairs are [i * materials + j], symmetric.
struct World {
  ShapeList shapes;
  std::vector<double> bounding_radii;  // one a shape
  std::vector<Material> materials;     // of pairs: materials.size() == material_count^2
  int material_count = 0;
  Vec3 gravity = Vec3::Zero();
  double contact_margin = 1.0;  // largest gap a speculative contact may have, lattice units
  std::shared_ptr<const LubricationLaw> lubrication;  // between smooth surfaces; null: none
  std::optional<SleepRule> sleep;                     // none: no body is ever held at rest

  const Material& pair(int i, int j) const { return materials[i * material_count + j]; }
};

}  // namespace silt::rigid
