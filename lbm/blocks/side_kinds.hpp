#pragma once
// The kinds of side of the domain, and the populations that outlets return.
#include <array>

#include "cpu/device_code.hpp"

namespace silt::lbm {

/// What lies at a side: the periodic image; a wall with a velocity (halfway bounce-back: no-slip and moving
/// walls and velocity inlets); a mirror; or, from `pressure` on, an outlet.
enum class SideKind { periodic, bounce, free_slip, pressure };
constexpr bool is_outlet(SideKind kind) {
  return kind >= SideKind::pressure;
}

/// One side of the domain.
struct SideCondition {
  SideKind kind = SideKind::periodic;
  std::array<double, 3> velocity{};  // of a wall or inlet, lattice units
  double density_deviation = 0;      // of an outlet of given pressure
  bool varies = false;               // whether the velocity changes over time
  /// Returns whether fluid passes through a side across this axis.
  bool is_open(int axis) const {
    return is_outlet(kind) || (kind == SideKind::bounce && velocity[axis] != 0);
  }
};

/// A population that left a cell of velocity u along c_j through an outlet, which returns one along -c_j.
struct LeftThroughOutlet {
  double value, twice_weight;  // 2 w_j
  double along, square;        // c_j.u, 3/2 u.u
};

/// An outlet of given pressure, by anti bounce-back.
struct PressureOutlet {
  double density_deviation;
  SILT_DEVICE double operator()(const LeftThroughOutlet& left) const {
    const double even = density_deviation + 4.5 * left.along * left.along - left.square;
    return left.twice_weight * even - left.value;
  }
};

/// Calls f with the outlet of a side (e.g. PressureOutlet); does nothing if the side is no outlet.
template <class F>
void with_outlet(const SideCondition& side, F&& f) {
  switch (side.kind) {
    case SideKind::pressure:
      return f(PressureOutlet{side.density_deviation});
    case SideKind::periodic:
    case SideKind::bounce:
    case SideKind::free_slip:
      return;
  }
}

}  // namespace silt::lbm
