#pragma once
// The kinds of side of the domain, and the populations that outlets return.
#include <array>

#include "cpu/device_code.hpp"

namespace silt::lbm {

/// What lies at a side: the periodic image; a wall with a velocity (halfway bounce-back: no-slip and moving
/// walls and velocity inlets); a mirror; or, from `pressure` on, an outlet. The last two are for the
/// temperature: a side of given temperature, and one through which the fluid carries heat. (For the
/// temperature, `bounce` insulates, or admits the heat that wall_addend derives from the velocity.)
enum class SideKind { periodic, bounce, free_slip, pressure, temperature, open };
constexpr bool is_outlet(SideKind kind) {
  return kind >= SideKind::pressure;
}

/// One side of the domain.
struct SideCondition {
  SideKind kind = SideKind::periodic;
  std::array<double, 3> velocity{};  // of a wall or inlet, lattice units
  double value = 0;     // held: of an outlet of given pressure the density deviation, else the temperature
  bool varies = false;  // whether the velocity changes over time
  /// Returns whether fluid passes through a side across this axis.
  bool is_open(int axis) const {
    return is_outlet(kind) || (kind == SideKind::bounce && velocity[axis] != 0);
  }
};

/// A population that left a cell of velocity u along c_j through an outlet, which returns one along -c_j.
struct LeftThroughOutlet {
  double value, twice_weight;  // 2 w_j
  double along, square;        // c_j.u, 3/2 u.u
  double sum;                  // of all populations that left the cell: of the temperature, this
};

/// An outlet of given pressure, by anti bounce-back.
struct PressureOutlet {
  double density_deviation;
  SILT_DEVICE double operator()(const LeftThroughOutlet& left) const {
    const double even = density_deviation + 4.5 * left.along * left.along - left.square;
    return left.twice_weight * even - left.value;
  }
};

/// A side of a given temperature (method-heat.md, equation H5).
struct TemperatureSide {
  double temperature;
  SILT_DEVICE double operator()(const LeftThroughOutlet& left) const {
    return left.twice_weight * temperature - left.value;
  }
};
/// A side with the temperature of the adjacent cell.
struct OpenSide {
  SILT_DEVICE double operator()(const LeftThroughOutlet& left) const {
    return left.twice_weight * left.sum - left.value;
  }
};

/// Calls f with the outlet of a side (e.g. PressureOutlet); does nothing if the side is no outlet.
template <class F>
void with_outlet(const SideCondition& side, F&& f) {
  switch (side.kind) {
    case SideKind::pressure:
      return f(PressureOutlet{side.value});
    case SideKind::temperature:
      return f(TemperatureSide{side.value});
    case SideKind::open:
      return f(OpenSide{});
    case SideKind::periodic:
    case SideKind::bounce:
    case SideKind::free_slip:
      return;
  }
}

}  // namespace silt::lbm
