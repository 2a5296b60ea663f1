#pragma once
// The temperature of a flow (method-heat.md), in lattice units: temperatures are those of the case less the
// reference temperature.
#include <array>
#include <optional>
#include <vector>

#include "lbm/collision/heat_rates.hpp"

namespace silt::coupler {

/// What a side of the domain is to the heat of the fluid: insulating without a temperature or a flux.
struct SideHeat {
  std::optional<double> temperature;
  double flux = 0;  // into the fluid, per area and step
};

/// What bodies of a kind or a wall are: insulating without a temperature.
struct BodyHeat {
  std::optional<double> temperature;  // at the start, of a body with a heat capacity
  double capacity = 0;  // of its mass, relative to that of the fluid; 0: it keeps its temperature
  double source = 0;    // heat that each body makes in a step
  bool operator==(const BodyHeat&) const = default;
};

struct HeatSpec : lbm::HeatSpec {
  double expansion = 0;  // β; with gravity it is the buoyancy
  double initial = 0;    // of the fluid at the start
  double of_fluid = 1;   // heat capacity of a cell of fluid, in lattice units of energy
  std::array<SideHeat, 6> sides;
  std::vector<BodyHeat> kinds, walls;  // of bodies, by kind; of [[walls]]

  /// Returns the temperature of a body of a kind at the start.
  double at_start(std::size_t kind) const { return kinds[kind].temperature.value_or(0); }
};

}  // namespace silt::coupler
