#pragma once
// Collision with two relaxation times (Ginzburg et al. 2008): the even half of each pair of populations
// relaxes with 1/tau, the odd half with 1/tau_odd, (tau - 1/2)(tau_odd - 1/2) = magic. BGK is the case
// tau_odd = tau. nu = (tau - 1/2)/3. Body force after Guo, Zheng, Shi 2002, split into its even and odd part
// alike.
//
// With s and d the sum and the difference of what arrives along i and against it, p + q leaves along i and
// p - q against it:
//     p = s (1 - omega_even)/2 + omega_even w_i [ rho + 9/2 (c.u)^2 - 3/2 u^2 ] + force
//     q = d (1 - omega_odd)/2 + omega_odd w_i 3 c.u + force
#include <cmath>
#include <limits>
#include <stdexcept>

#include "lbm/collision_model.hpp"

namespace silt::lbm {

/// What the kernel multiplies with, for a diagonal direction (w = 1/36); along an axis it is twice that, at
/// rest twelve times. Rounding a rate must not make or destroy mass or momentum, step after step the same
/// way: density and momentum are multiples of a number so small that what p and q keep of s and d is exact.
template <class T>
struct CollisionRates {
  T density;   // omega_even/36, of rho
  T square;    // omega_even/24, of u_d u_d: a third of it in an even half, and less of it in all of them
  T momentum;  // omega_odd/12, of u
  T keep_even, keep_even_twice, keep_odd;  // (1 - omega)/2
  T half_force[3], even_force[3], odd_force[3];
  T mass_correction = 0;  // added to the density of every cell
  bool source = false;    // force or mass correction present

  explicit CollisionRates(const CollisionSpec& s) {
    if (!(s.relaxation_time > 0.5)) throw std::invalid_argument("the relaxation time must be above 1/2");
    const double tau_odd = s.odd_relaxation_time();
    density = on_grid(1 / s.relaxation_time / 36), momentum = on_grid(1 / tau_odd / 12);
    square = T(1.5 * density);
    keep_even_twice = T(1 - 36 * double(density)), keep_even = keep_even_twice / 2;
    keep_odd = T(1 - 12 * double(momentum)) / 2;
    for (int d = 0; d < 3; ++d) {
      half_force[d] = T(s.force[d] / 2);
      even_force[d] = T((1 - 0.5 / s.relaxation_time) / 12 * s.force[d]);
      odd_force[d] = T((1 - 0.5 / tau_odd) / 12 * s.force[d]);
      source |= s.force[d] != 0;
    }
  }

 private:
  static T on_grid(double rate) {
    const int bits = std::numeric_limits<T>::digits + 2;
    return T(std::ldexp(std::nearbyint(std::ldexp(rate, bits)), -bits));
  }
};

}  // namespace silt::lbm
