#pragma once
// The sides of the domain, for fluid and bodies.
#include <array>
#include <string_view>

#include "coupler/spec/name_table.hpp"
#include "lbm/blocks/side_kinds.hpp"
#include "rigid/bodies/prescribed_motion.hpp"
#include "rigid/math/types.hpp"

namespace silt::coupler {

enum class Side { x_low, x_high, y_low, y_high, z_low, z_high };
inline constexpr auto side_names = names_of<Side>("x-low", "x-high", "y-low", "y-high", "z-low", "z-high");

enum class BoundaryKind { periodic, no_slip, moving, free_slip, velocity_inlet, pressure_outlet };

/// The properties of a kind of side.
struct BoundaryTraits {
  std::string_view name;
  lbm::SideKind fluid;                              // SideKind of the fluid
  bool is_wall = false;                             // moves fluid and touching bodies at its velocity
  bool is_inlet = false;                            // needs an outlet elsewhere
  bool has_velocity = false, has_pressure = false;  // keys in a case
};
/// The kinds in the order of the enumerators.
inline constexpr auto boundary_kinds = std::to_array<BoundaryTraits>({
    {.name = "periodic", .fluid = lbm::SideKind::periodic},
    {.name = "no-slip", .fluid = lbm::SideKind::bounce, .is_wall = true},
    {.name = "moving", .fluid = lbm::SideKind::bounce, .is_wall = true, .has_velocity = true},
    {.name = "free-slip", .fluid = lbm::SideKind::free_slip},
    {.name = "velocity-inlet", .fluid = lbm::SideKind::bounce, .is_inlet = true, .has_velocity = true},
    {.name = "pressure-outlet", .fluid = lbm::SideKind::pressure, .has_pressure = true},
});
inline constexpr auto boundary_names = names_of<BoundaryKind>(boundary_kinds);

struct BoundarySpec {
  BoundaryKind kind = BoundaryKind::periodic;
  rigid::Vec3 velocity = rigid::Vec3::Zero();  // moving walls and inlets
  rigid::OverTime over_time;                   // of the velocity
  double pressure = 0;                         // outlets; less that of the reference density
  bool solid_for_bodies = true;                // a half-space for bodies, unless periodic
  const BoundaryTraits& traits() const { return boundary_kinds[static_cast<std::size_t>(kind)]; }
  bool is_periodic() const { return kind == BoundaryKind::periodic; }
  bool is_inlet() const { return traits().is_inlet; }
  bool is_outlet() const { return lbm::is_outlet(traits().fluid); }
  bool is_open() const { return is_inlet() || is_outlet(); }
  bool is_wall() const { return traits().is_wall; }
  rigid::Vec3 velocity_at(double time) const { return over_time.at(time) * velocity; }
  double largest_speed() const { return over_time.most() * velocity.norm(); }
  bool stops_bodies() const { return !is_periodic() && solid_for_bodies; }
  /// Returns whether bodies that pass the side are removed.
  bool removes_bodies() const { return !is_periodic() && !solid_for_bodies; }
};

}  // namespace silt::coupler
