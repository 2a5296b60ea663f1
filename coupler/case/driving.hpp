#pragma once
// What drives the bodies of a case, and how fast they will fall or rise in its fluid.
#include <string>
#include <vector>

namespace silt::coupler {

struct Case;

/// Returns the speed at which a sphere falls or rises steadily in unbounded fluid, by the drag law of
/// Schiller and Naumann (1933), C_D = 24/Re (1 + 0.15 Re^0.687). Lattice units; density relative to the
/// fluid's; negative never.
double terminal_velocity(double diameter, double density, double gravity, double kinematic_viscosity);

/// The free bodies of one entry; lattice units.
struct Fall {
  std::string entry;  // "bodies[2]", "fill[0]"
  double diameter, density, hindrance;
  double start = 0, height = 0;  // speed at the start; how far it can fall
  double speed = 0;              // that it comes to
};

/// Returns the falls of all entries of free bodies, each of a sphere of the body's volume: at terminal
/// velocity less what the others take from it, (1 - volume fraction)^2.4 at the least (Richardson, Zaki
/// 1954), or at what free fall with the fluid's added mass gains on the way to the next wall or to the end of
/// the run. None without a fluid or gravity.
std::vector<Fall> expected_falls(const Case&);

/// Returns the share of gravity under which a fall comes to a speed.
double gravity_share(const Case&, const Fall&, double speed);

}  // namespace silt::coupler
