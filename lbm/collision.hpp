#pragma once
// Collision with two relaxation times (Ginzburg et al. 2008): the even half of each pair of populations
// relaxes with 1/tau, the odd half with 1/tau_odd, (tau - 1/2)(tau_odd - 1/2) = magic. BGK is the case
// tau_odd = tau. nu = (tau - 1/2)/3. Body force after Guo, Zheng, Shi 2002, split into its even and odd part
// alike.
#include <array>
#include <stdexcept>

namespace silt::lbm {

struct CollisionSpec {
  double relaxation_time = 1;
  double magic = 1.0 / 6;  // ignored by bgk
  bool bgk = false;
  std::array<double, 3> force{};  // acceleration of the fluid, uniform
};

/// What the kernel multiplies with. `anchor` is added to every cell's density, w_i anchor to each population.
template <class T>
struct CollisionRates {
  T omega_even, omega_odd, force_even, force_odd;
  T fx, fy, fz;
  T anchor = 0;
  bool source = false;  // force or anchor present

  explicit CollisionRates(const CollisionSpec& s) {
    if (!(s.relaxation_time > 0.5)) throw std::invalid_argument("the relaxation time must be above 1/2");
    const double tau_odd = s.bgk ? s.relaxation_time : 0.5 + s.magic / (s.relaxation_time - 0.5);
    omega_even = T(1 / s.relaxation_time), omega_odd = T(1 / tau_odd);
    force_even = T(1 - 0.5 / s.relaxation_time), force_odd = T(1 - 0.5 / tau_odd);
    fx = T(s.force[0]), fy = T(s.force[1]), fz = T(s.force[2]);
    source = s.force[0] != 0 || s.force[1] != 0 || s.force[2] != 0;
  }
};

}  // namespace silt::lbm
