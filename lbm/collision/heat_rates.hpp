#pragma once
// The numbers by which the temperature spreads and acts on the fluid.
#include <array>
#include <stdexcept>

#include "lbm/blocks/lattice.hpp"
#include "lbm/collision/collision_model.hpp"

namespace silt::lbm {

struct HeatSpec {
  double diffusivity = 1. / 6;             // D, cells²/step
  std::array<double, 3> buoyancy{};        // acceleration of the fluid for a unit of temperature: −β g
  double reference = 0;                    // temperature of the case from which populations count
  std::array<double, 3> gradient{};        // G, that of a mean temperature on which the populations' is
  static constexpr double magic = 1. / 6;  // Λ of (H4)

  constexpr double excess() const { return 4 * diffusivity; }          // τ_T⁻ − 1/2
  constexpr double relaxation_time() const { return 0.5 + excess(); }  // τ_T⁻
  bool has_gradient() const { return gradient[0] != 0 || gradient[1] != 0 || gradient[2] != 0; }
  /// Returns c_i·G, for a direction of D3Q7.
  double gradient_along(int i) const {
    return i == 0 ? 0 : i % 2 ? gradient[(i - 1) / 2] : -gradient[(i - 1) / 2];
  }
};

/// Returns the equilibrium (H1) of weight w_i along c_i of D3Q7.
inline double heat_equilibrium(int i, double temperature, const std::array<double, 3>& velocity) {
  const Int3 c = D3Q7::c[i];
  return D3Q7::w(i) * temperature * (1 + 4 * (c.x * velocity[0] + c.y * velocity[1] + c.z * velocity[2]));
}

/// The rates of (H2) and (H3), and the force on the fluid.
template <class T>
struct HeatRates {
  T even;                                        // 1/τ_T
  T odd;                                         // 1/τ_T⁻
  T along;                                       // (τ_T⁻ − 1/2), the share along the stream in (H3)
  T quarter;                                     // τ_T⁻/4
  T half_force[3], even_force[3], odd_force[3];  // of a unit of temperature, as in CollisionRates
  T gradient[3];                                 // G

  bool has_force() const { return half_force[0] != 0 || half_force[1] != 0 || half_force[2] != 0; }
  bool has_gradient() const { return gradient[0] != 0 || gradient[1] != 0 || gradient[2] != 0; }

  /// Throws std::invalid_argument for a diffusivity that is not above 0.
  HeatRates(const HeatSpec& heat, CollisionSpec fluid) {
    if (!(heat.diffusivity > 0)) throw std::invalid_argument("the thermal diffusivity must be above 0");
    const double excess = heat.excess();
    even = T(1 / (0.5 + HeatSpec::magic / excess));
    odd = T(1 / (0.5 + excess)), along = T(excess), quarter = T((0.5 + excess) / 4);
    fluid.force = heat.buoyancy;
    const CollisionRates<T> of_one(fluid);
    for (int d = 0; d < 3; ++d) {
      half_force[d] = of_one.half_force[d], gradient[d] = T(heat.gradient[d]);
      even_force[d] = of_one.even_force[d], odd_force[d] = of_one.odd_force[d];
    }
  }
};

}  // namespace silt::lbm
