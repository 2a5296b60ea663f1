#pragma once
// The fluid sees beyond a free-slip side the mirror image of what lies before it, its bodies and walls
// included.
#include "lbm/blocks/lattice.hpp"

namespace silt::coupler {

/// The reflection of an image of a body at free-slip sides; of none for an image inside the domain.
struct Reflection {
  lbm::Int3 side{0, 0, 0};   // per axis: -1, 1: reflected at the lower, the upper side; 0: not reflected
  lbm::Int3 twice{0, 0, 0};  // twice the coordinates of these sides, in cells

  bool any() const { return side.x != 0 || side.y != 0 || side.z != 0; }
  /// Returns the factor of component d of vectors, as of velocity and force.
  int of_vector(int d) const { return side[d] == 0 ? 1 : -1; }
  /// Returns the factor of component d of axial vectors, as of angular velocity and torque.
  int of_axial(int d) const { return of_vector((d + 1) % 3) * of_vector((d + 2) % 3); }
  /// Returns the factor of component d of a motion (v, omega), or of a load (force, torque).
  int of_motion(int d) const { return d < 3 ? of_vector(d) : of_axial(d - 3); }
  template <class Vec3>
  Vec3 point(Vec3 x) const {
    for (int d = 0; d < 3; ++d) x[d] = twice[d] + of_vector(d) * x[d];
    return x;
  }
  /// Returns the image of a cell; `low` is the cell of the domain from which it counts.
  lbm::Int3 cell(lbm::Int3 c, lbm::Int3 low) const {
    for (int d = 0; d < 3; ++d)
      if (side[d] != 0) c[d] = twice[d] - 2 * low[d] - 1 - c[d];
    return c;
  }
  lbm::Int3 direction(lbm::Int3 c) const {
    return {of_vector(0) * c.x, of_vector(1) * c.y, of_vector(2) * c.z};
  }
  bool operator==(const Reflection&) const = default;
};

}  // namespace silt::coupler
