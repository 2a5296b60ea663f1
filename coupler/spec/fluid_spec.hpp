#pragma once
// The parameters of the fluid, in lattice units, and its state at the start.
#include "coupler/spec/name_table.hpp"
#include "lbm/collision/collision_model.hpp"
#include "rigid/bodies/prescribed_motion.hpp"
#include "rigid/math/types.hpp"

namespace silt::coupler {

enum class Precision { single_, double_ };
inline constexpr auto precision_names = names_of<Precision>("single", "double");

inline constexpr auto collision_names = names_of<lbm::Collision>(lbm::collision_models);

/// The initial velocity field; Taylor-Green vortices and shear layers have one wave per period.
enum class InitialFlow { rest, uniform, taylor_green, taylor_green_3d, shear_layer, vortex };
inline constexpr auto initial_flow_names =
    names_of<InitialFlow>("rest", "uniform", "taylor-green", "taylor-green-3d", "shear-layer", "vortex");

/// The initial state; initial_flow.cpp has the formulas.
struct InitialSpec {
  InitialFlow type = InitialFlow::rest;
  rigid::Vec3 velocity = rigid::Vec3::Zero();  // of the stream; else its norm is the amplitude
  double steepness = 80;                       // of shear layers: period divided by thickness
  double swirl = 0, radius = 0;                // of a vortex: largest speed, and its radius
  double noise = 0;                            // largest component of each cell's random velocity

  /// Speed across shear layers relative to that along them (Minion, Brown 1997).
  static constexpr double perturbation = 0.05;

  double largest_speed() const {
    return velocity.norm() * (1 + (type == InitialFlow::shear_layer) * perturbation) + swirl;
  }
};

struct FluidSpec {
  double kinematic_viscosity = 0, relaxation_time = 0;
  lbm::Collision collision = lbm::Collision::trt;
  bool collision_by_scene = false;  // "auto": chosen for the scene
  double magic = 1. / 6;            // Lambda; with bodies or [[walls]] best_magic of the wall scheme
  Precision precision = Precision::single_;
  rigid::Vec3 body_force = rigid::Vec3::Zero();  // acceleration of the fluid
  rigid::OverTime body_force_over_time;
  /// The mean velocity over all cells to which the body force is controlled; 0 along an axis: no control.
  rigid::Vec3 superficial_velocity = rigid::Vec3::Zero();
  bool body_force_on_bodies = false;  // as a pressure gradient, which acts on free bodies too
  InitialSpec initial;
  bool quiet_start = false;  // from rest, with the pressure that balances the loads

  bool has_body_force() const { return !body_force.isZero(0) || !superficial_velocity.isZero(0); }
};

}  // namespace silt::coupler
