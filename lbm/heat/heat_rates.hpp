#pragma once
// The numbers by which the temperature spreads and acts on the fluid.
#include <array>
#include <stdexcept>

namespace silt::lbm {

struct HeatSpec {
  double diffusivity = 1. / 6;             // D, cells²/step
  std::array<double, 3> buoyancy{};        // acceleration of the fluid for a unit of temperature: −β g
  double reference = 0;                    // temperature of the case from which populations count
  static constexpr double magic = 1. / 6;  // Λ of (H4)

  constexpr double excess() const { return 4 * diffusivity; }  // τ_T⁻ − 1/2
  bool has_buoyancy() const { return buoyancy[0] != 0 || buoyancy[1] != 0 || buoyancy[2] != 0; }
};

/// The rates of (H2) and (H3).
template <class T>
struct HeatRates {
  T even;           // 1/τ_T
  T odd;            // 1/τ_T⁻
  T along;          // (τ_T⁻ − 1/2), the share along the stream in (H3)
  T quarter;        // τ_T⁻/4
  T half_force[3];  // of the body force of the fluid
  T half_buoyancy[3];

  HeatRates(const HeatSpec& heat, const std::array<double, 3>& force) {
    if (!(heat.diffusivity > 0)) throw std::invalid_argument("the thermal diffusivity must be above 0");
    const double excess = heat.excess();
    even = T(1 / (0.5 + HeatSpec::magic / excess));
    odd = T(1 / (0.5 + excess)), along = T(excess), quarter = T((0.5 + excess) / 4);
    for (int d = 0; d < 3; ++d) half_force[d] = T(force[d] / 2), half_buoyancy[d] = T(heat.buoyancy[d] / 2);
  }
};

}  // namespace silt::lbm
