#pragma once
// The shapes, materials and laws of the bodies, which all ranks know alike.
#include <algorithm>
#include <memory>
#include <vector>

#include "rigid/bodies/lubrication.hpp"
#include "rigid/shapes/shape_fwd.hpp"

namespace silt::rigid {

/// The properties of a contact of two materials.
struct Material {
  double restitution = 0, friction = 0;
  // moments against rolling and twisting, over the normal impulse times the least reduced radius
  double rolling_friction = 0, twisting_friction = 0;
  double cohesion = 0;                    // force that holds bodies in contact together
  double hamaker = 0, hamaker_gap = 0.0;  // energy; the gap below which the attraction grows no more

  bool rolls_freely() const { return rolling_friction == 0 && twisting_friction == 0; }
  bool pulls() const { return cohesion > 0 || hamaker > 0; }
  /// Says whether a law of it depends on the reduced radii of a contact.
  bool asks_for_radii() const { return !rolls_freely() || hamaker > 0; }
  /// The gap up to which the attraction of van der Waals acts: there it is a hundredth of the greatest.
  double van_der_waals_reach() const { return hamaker > 0 ? 10 * hamaker_gap : 0; }
};

/// Tables of pairs are [i * materials + j], symmetric.
struct World {
  ShapeList shapes;
  std::vector<double> bounding_radii;  // one a shape
  std::vector<Material> materials;     // of pairs: materials.size() == material_count^2
  int material_count = 0;
  Vec3 gravity = Vec3::Zero();
  double contact_margin = 1.0;  // largest gap a speculative contact may have, lattice units
  std::shared_ptr<const LubricationLaw> lubrication;  // between smooth surfaces; null: none

  /// The widest gap across which bodies attract each other.
  double van_der_waals_reach() const {
    double reach = 0;
    for (const Material& material : materials) reach = std::max(reach, material.van_der_waals_reach());
    return reach;
  }
  bool asks_for_radii() const {
    return std::ranges::any_of(materials, [](const Material& m) { return m.asks_for_radii(); });
  }
  const Material& pair(int i, int j) const { return materials[i * material_count + j]; }
};

}  // namespace silt::rigid
