#pragma once
// The kinds of side of the domain, and what outlets return for populations that leave through them.
#include <array>

#include "cpu/device_code.hpp"

namespace silt::lbm {

/// What a population meets: its periodic image; a wall, with a velocity (halfway bounce-back: no-slip, a
/// moving wall and a velocity inlet alike); a mirror; or, from `pressure` on, one of the outlets.
enum class SideKind { periodic, bounce, free_slip, pressure };
constexpr bool is_outlet(SideKind kind) {
  return kind >= SideKind::pressure;
}

/// One side of the domain.
struct SideCondition {
  SideKind kind = SideKind::periodic;
  std::array<double, 3> velocity{};  // of a wall
  double density_deviation = 0;      // of an outlet of given pressure
  bool varies = false;               // the velocity, over time
  /// Returns whether fluid passes, on a side across this axis.
  bool is_open(int axis) const {
    return is_outlet(kind) || (kind == SideKind::bounce && velocity[axis] != 0);
  }
};

/// A population that left a cell of velocity u along c_j, for which an outlet returns one along -c_j.
struct LeftThroughOutlet {
  double value, twice_weight;  // 2 w_j
  double along, square;        // c_j.u, 3/2 u.u
};

/// Given pressure, by anti bounce-back.
struct PressureOutlet {
  double density_deviation;
  SILT_DEVICE double operator()(const LeftThroughOutlet& left) const {
    const double even = density_deviation + 4.5 * left.along * left.along - left.square;
    return left.twice_weight * even - left.value;
  }
};

/// Calls f with what a side returns, if it is an outlet.
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
