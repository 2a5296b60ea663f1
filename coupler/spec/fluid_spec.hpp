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

/// The velocity of the fluid at the start; of the Taylor-Green vortices and the layers one wave a period.
enum class InitialFlow { rest, uniform, taylor_green, taylor_green_3d, shear_layer, vortex };
inline constexpr auto initial_flow_names =
    names_of<InitialFlow>("rest", "uniform", "taylor-green", "taylor-green-3d", "shear-layer", "vortex");

/// The flow begins with this state (initial_flow.cpp has the formulas).
struct InitialSpec {
  InitialFlow type = InitialFlow::rest;
  rigid::Vec3 velocity = rigid::Vec3::Zero();  // of the stream; its length is the amplitude of the others
  double steepness = 80;                       // of shear layers: period over thickness
  double swirl = 0, radius = 0;                // of a vortex: largest speed, where it is
  double noise = 0;                            // largest component of a random velocity of each cell

  /// The speed across shear layers is this share of that along them (Minion, Brown 1997).
  static constexpr double perturbation = 0.05;

  double largest_speed() const {
    return velocity.norm() * (1 + (type == InitialFlow::shear_layer) * perturbation) + swirl;
  }
};

struct FluidSpec {
  double kinematic_viscosity = 0, relaxation_time = 0;
  lbm::Collision collision = lbm::Collision::trt;
  bool collision_by_scene = false;  // "auto": chosen once the scene is known
  double magic = 1. / 6;            // Lambda; with bodies or [[walls]] best_magic of the wall scheme
  Precision precision = Precision::single_;
  rigid::Vec3 body_force = rigid::Vec3::Zero();  // acceleration of the fluid
  rigid::OverTime body_force_over_time;
  /// Mean over all cells that the body force is controlled for, along the axes on which it is not 0.
  rigid::Vec3 superficial_velocity = rigid::Vec3::Zero();
  bool body_force_on_bodies = false;  // it stands for a pressure gradient, which pushes free bodies too
  InitialSpec initial;
  bool quiet_start = false;  // from rest: with the pressure that the loads ask for

  bool has_body_force() const { return !body_force.isZero(0) || !superficial_velocity.isZero(0); }
};

}  // namespace silt::coupler
