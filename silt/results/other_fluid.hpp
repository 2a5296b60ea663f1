#pragma once
// The fluid of another run in the units of this one, for a run that begins where the other ended.
#include <array>
#include <optional>

#include "lbm/blocks/moments.hpp"
#include "lbm/collision/heat_rates.hpp"

namespace silt {

/// The factors that convert the temperature of an earlier run.
struct HeatScales {
  double shift = 0;            // its reference temperature less that of this run
  double off_equilibrium = 1;  // of the populations: what keeps the gradient
};

/// The factors that convert the fluid of an earlier run to the lattice units of this run.
struct FluidScales {
  double length = 1;  // the width of its cells in those of the earlier run
  double velocity = 1, pressure = 1;
  double off_equilibrium = 1;      // of the populations: what keeps the rate of strain
  std::optional<HeatScales> heat;  // none: not both runs have a temperature

  int populations() const { return lbm::D3Q19::directions + (heat ? lbm::D3Q7::directions : 0); }
};

/// The fluid of a cell: density, momentum, temperature, and what of its populations is not equilibrium.
struct CellFluid {
  static constexpr int first_of_heat = lbm::D3Q19::directions, most = first_of_heat + lbm::D3Q7::directions;
  double rho = 0, temperature = 0;
  std::array<double, 3> j{};
  double rest[most] = {};  // of the fluid, then of the temperature

  /// Makes `rest`, which has the populations, what is not equilibrium of them.
  void split() {
    for (int i = 0; i < lbm::D3Q19::directions; ++i) {
      rho += rest[i];
      for (int d = 0; d < 3; ++d) j[d] += lbm::D3Q19::c[i][d] * rest[i];
    }
    for (int i = 0; i < lbm::D3Q7::directions; ++i) temperature += rest[first_of_heat + i];
    for (int q = 0; q < most; ++q) rest[q] -= equilibrium(q, rho, temperature, j);
  }
  void add(double weight, const CellFluid& other) {
    rho += weight * other.rho, temperature += weight * other.temperature;
    for (int d = 0; d < 3; ++d) j[d] += weight * other.j[d];
    for (int q = 0; q < most; ++q) rest[q] += weight * other.rest[q];
  }
  /// Returns a population in the units of this run.
  double population(int q, const FluidScales& scales) const {
    const double shift = scales.heat ? scales.heat->shift : 0;
    const double off = q < first_of_heat ? scales.off_equilibrium : scales.heat->off_equilibrium;
    const std::array<double, 3> scaled{scales.velocity * j[0], scales.velocity * j[1],
                                       scales.velocity * j[2]};
    return equilibrium(q, scales.pressure * rho, temperature + shift, scaled) + off * rest[q];
  }

 private:
  static double equilibrium(int q, double rho, double temperature, const std::array<double, 3>& j) {
    return q < first_of_heat ? lbm::equilibrium(q, rho, j.data())
                             : lbm::heat_equilibrium(q - first_of_heat, temperature, j);
  }
};

}  // namespace silt
