#pragma once
// The shapes, materials and laws of the bodies, the same on all ranks.
#include <algorithm>
#include <memory>
#include <vector>

#include "rigid/bodies/lubrication.hpp"
#include "rigid/shapes/shape_fwd.hpp"

namespace silt::rigid {

/// The contact properties of a pair of materials.
struct Material {
  double restitution = 0, friction = 0;
  // moments that resist rolling and twisting, over the normal impulse times the least reduced radius
  double rolling_friction = 0, twisting_friction = 0;
  double cohesion = 0;                    // attractive force between bodies in contact
  double hamaker = 0, hamaker_gap = 0.0;  // energy; gap below which the attraction is constant

  bool rolls_freely() const { return rolling_friction == 0 && twisting_friction == 0; }
  bool pulls() const { return cohesion > 0 || hamaker > 0; }
  /// Returns whether the law needs the reduced radii of a contact.
  bool needs_radii() const { return !rolls_freely() || hamaker > 0; }
  /// Returns the range of the van der Waals attraction, where it is a hundredth of its maximum.
  double van_der_waals_reach() const { return hamaker > 0 ? 10 * hamaker_gap : 0; }
};

/// Tables of pairs are symmetric, with the index i * materials + j.
struct World {
  ShapeList shapes;
  std::vector<double> bounding_radii;  // one a shape
  std::vector<Material> materials;     // of pairs: materials.size() == material_count^2
  int material_count = 0;
  Vec3 gravity = Vec3::Zero();
  double contact_margin = 1.0;  // largest gap a speculative contact may have, lattice units
  std::shared_ptr<const LubricationLaw> lubrication;  // between smooth surfaces; null: none

  /// Returns the widest gap across which bodies attract each other.
  double van_der_waals_reach() const {
    double reach = 0;
    for (const Material& material : materials) reach = std::max(reach, material.van_der_waals_reach());
    return reach;
  }
  bool needs_radii() const {
    return std::ranges::any_of(materials, [](const Material& m) { return m.needs_radii(); });
  }
  const Material& pair(int i, int j) const { return materials[i * material_count + j]; }
};

}  // namespace silt::rigid
