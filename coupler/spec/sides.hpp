#pragma once
// The sides of the domain: what fluid and bodies meet there.
#include "coupler/spec/name_table.hpp"
#include "rigid/bodies/prescribed_motion.hpp"
#include "rigid/math/types.hpp"

namespace silt::coupler {

enum class Side { x_low, x_high, y_low, y_high, z_low, z_high };
inline constexpr auto side_names = names_of<Side>("x-low", "x-high", "y-low", "y-high", "z-low", "z-high");

enum class BoundaryKind { periodic, no_slip, moving, free_slip, velocity_inlet, pressure_outlet };
inline constexpr auto boundary_names =
    names_of<BoundaryKind>("periodic", "no-slip", "moving", "free-slip", "velocity-inlet", "pressure-outlet");

struct BoundarySpec {
  BoundaryKind kind = BoundaryKind::periodic;
  rigid::Vec3 velocity = rigid::Vec3::Zero();  // moving walls and inlets
  rigid::OverTime over_time;                   // of the velocity
  double density = 1;                          // outlets
  bool solid_for_bodies = true;                // a half-space for bodies (every kind but periodic)
  rigid::Vec3 velocity_at(double time) const { return over_time.at(time) * velocity; }
  double largest_speed() const { return over_time.most() * velocity.norm(); }
  bool has_velocity() const { return kind == BoundaryKind::moving || kind == BoundaryKind::velocity_inlet; }
  /// Bodies beyond it are taken out.
  bool removes_bodies() const { return kind != BoundaryKind::periodic && !solid_for_bodies; }
};

}  // namespace silt::coupler
