#pragma once
// Flows with closed forms, in lattice units: what a run is compared with.
#include <array>
#include <functional>

#include "rigid/math/types.hpp"

namespace silt::coupler {

struct Case;
enum class Profile;

/// TaylorGreen is the two-dimensional Taylor-Green vortex in the x-y plane, one wave a period:
///   u = A (-cos kx x sin ky y,  kx/ky sin kx x cos ky y) e^(-nu (kx^2 + ky^2) t),  exact for incompressible
///   flow, p = -A^2/4 (cos 2 kx x + (kx/ky)^2 cos 2 ky y) e^(-2 nu (kx^2 + ky^2) t).
struct TaylorGreen {
  double amplitude, kx, ky, viscosity;
  explicit TaylorGreen(const Case&);  // amplitude: length of fluid.initial.velocity

  double decay_rate() const { return viscosity * (kx * kx + ky * ky); }
  std::array<double, 3> velocity(double x, double y, double t) const;
  double density_deviation(double x, double y, double t) const;  // 3 p
  /// Returns the symmetric velocity gradient: xx, yy, xy.
  std::array<double, 3> strain_rate(double x, double y, double t) const;
};

/// A steady flow between walls that has a closed form.
struct ExactProfile {
  std::function<rigid::Vec3(const rigid::Vec3& x)> velocity;  // cell centres are at +1/2
  double largest;                                             // speed: what errors are relative to
};

/// Returns the flow "channel" (walls across one axis), "duct" (across two) or "pipe" (a tube that slides and
/// turns), from the walls and the body force of a case. CaseError if it has others.
ExactProfile exact_profile(const Case&, Profile);

}  // namespace silt::coupler
