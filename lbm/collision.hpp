#pragma once
// The rates of a collision as the dense kernel multiplies with them (method.md, equations 3 to 7 and 24 to
// 28).
#include "lbm/collision_model.hpp"

namespace silt::lbm {

/// The numbers are those of a diagonal direction (w = 1/36); along an axis they are twice that, at rest
/// twelve times. Rounding a rate must not make or destroy mass or momentum, step after step the same way:
/// density and momentum are multiples of a number so small that what is kept of the populations is exact.
template <class T>
struct CollisionRates {
  Collision model;
  T density;   // omega_even/36, of rho
  T square;    // omega_even/24, of u_d u_d: a third of it in an even half, and less of it in all of them
  T momentum;  // omega_odd/12, of u
  T keep_even, keep_even_twice, keep_odd;  // (1 - omega)/2
  T half_force[3], even_force[3], odd_force[3];
  T keep_third,
      keep_fourth;        // of regularised: what is left of moments beyond those that follow from the stress
  T resolved_square;      // half the square of the stress off equilibrium up to which no eddy is more viscous
  T eddy;                 // 9 C^2; 0: none
  T mass_correction = 0;  // added to the density of every cell

  /// Throws std::invalid_argument for a relaxation time of 1/2 or less.
  explicit CollisionRates(const CollisionSpec&);
  /// Whether there is a force or a mass correction.
  bool has_source() const {
    return half_force[0] != 0 || half_force[1] != 0 || half_force[2] != 0 || mass_correction != 0;
  }
};

}  // namespace silt::lbm
