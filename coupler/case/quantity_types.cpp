#include "coupler/case/quantity_types.hpp"

#include <algorithm>
#include <stdexcept>

namespace silt::coupler {

namespace {

using Q = QuantityType;

constexpr Dimension mass_rate{0, -1, 1}, specific_energy{2, -2, 0}, specific_energy_rate{2, -3, 0};

constexpr QuantityType types[] = {
    {"max-speed", dimension::velocity, Q::body, Q::bodies},
    {"drag-coefficient", dimension::none, Q::body | Q::axis, Q::fluid | Q::bodies},
    {"superficial-velocity", dimension::velocity, Q::body | Q::axis, Q::fluid},
    {"profile-error", dimension::none, Q::profile, Q::fluid},
    {"taylor-green-velocity", dimension::none, 0, Q::fluid},
    {"taylor-green-decay", dimension::none, 0, Q::fluid},
    {"kinetic-energy", specific_energy, Q::instant, Q::fluid},
    {"dissipation", specific_energy_rate, Q::instant, Q::fluid},
    {"mean-height", dimension::length, Q::body | Q::axis, Q::bodies},
    {"drift", dimension::length, Q::body, Q::bodies},
    {"max-height-after", dimension::length, Q::body | Q::axis | Q::time, Q::bodies},
    {"displacement", dimension::length, Q::body | Q::axis, Q::bodies},
    {"mean-velocity", dimension::velocity, Q::body | Q::axis, Q::bodies},
    {"mean-angular-velocity", dimension::angular_velocity, Q::body | Q::axis, Q::bodies},
    {"max-penetration", dimension::length, 0, Q::bodies},
    {"momentum-change", dimension::none, Q::body | Q::axis, Q::bodies},
    {"angular-momentum-change", dimension::none, Q::body, Q::bodies},
    {"energy-change", dimension::none, Q::body, Q::bodies},
    {"energy-growth", dimension::none, Q::body, Q::bodies | Q::undriven},
    {"last-reversal", dimension::time, Q::body, Q::bodies},
    {"discharge-rate", mass_rate, Q::body | Q::axis | Q::height | Q::time, Q::bodies},
    {"bed-angle", dimension::none, Q::body | Q::axis | Q::centre | Q::time, Q::bodies | Q::gravity},
    {"rebound-ratio", dimension::none, Q::body | Q::axis | Q::height, Q::bodies},
    {"axis-distance", dimension::length, Q::body | Q::wall, Q::bodies},
    {"wall-stress", dimension::pressure, Q::side | Q::axis | Q::time, Q::fluid},
    {"wall-force", dimension::force, Q::wall | Q::axis | Q::time, 0},
    {"wall-torque", dimension::torque, Q::wall | Q::time, 0},
    {"relative-viscosity", dimension::none, Q::axis | Q::time, Q::fluid},
    {"packing-fraction", dimension::none, Q::body | Q::box, Q::bodies},
};

}  // namespace

std::span<const QuantityType> quantity_types() {
  return types;
}

const QuantityType& quantity_type(std::string_view name) {
  const auto* found =
      std::find_if(std::begin(types), std::end(types), [&](const Q& type) { return type.name == name; });
  if (found == std::end(types)) throw std::logic_error("not a type of a quantity: " + std::string(name));
  return *found;
}

}  // namespace silt::coupler
