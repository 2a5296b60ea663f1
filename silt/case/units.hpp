#pragma once
// Converts between units of a case and lattice units: x_lattice = lattice(x_case, dimension) and x_case =
// physical(x_lattice, dimension). In a case in lattice units all scales are 1.
#include <string>

#include "rigid/math/elementary.hpp"

namespace silt {

struct Dimension {  // exponents of length, time, mass
  int length, time, mass;
  bool is_energy = false;  // else the same exponents are those of a torque
  bool operator==(const Dimension&) const = default;
};
namespace dimension {
inline constexpr Dimension none{0, 0, 0}, length{1, 0, 0}, time{0, 1, 0}, velocity{1, -1, 0},
    acceleration{1, -2, 0}, momentum{1, -1, 1}, viscosity{2, -1, 0}, dynamic_viscosity{-1, -1, 1},
    density{-3, 0, 1}, mass{0, 0, 1}, force{1, -2, 1}, torque{2, -2, 1}, angular_velocity{0, -1, 0},
    energy{2, -2, 1, true}, pressure{-1, -2, 1};
}

struct Units {
  double cell_size = 1, time_step = 1, density = 1;  // in the units of the case
  bool si = false;

  /// Returns one lattice unit of a quantity in units of the case.
  double scale(Dimension d) const {
    const double mass = density * cell_size * cell_size * cell_size;
    using rigid::elementary::power;
    return power(cell_size, d.length) * power(time_step, d.time) * power(mass, d.mass);
  }
  double lattice(double x, Dimension d) const { return x / scale(d); }
  double physical(double x, Dimension d) const { return x * scale(d); }
  /// Returns the unit of a quantity in the case: "m/s", "cells/step"; "" for a number.
  std::string unit_text(Dimension) const;
};

}  // namespace silt
