#pragma once
// The fluid: the table [fluid] of a case.
#include <string>

#include "lbm/collision_model.hpp"
#include "rigid/math/types.hpp"

namespace silt::coupler {

enum class Precision { single_, double_ };

struct FluidSpec {
  double kinematic_viscosity = 0, relaxation_time = 0;
  lbm::Collision collision = lbm::Collision::trt;
  double magic = 1. / 6;  // Lambda; with bodies or [[walls]] best_magic of the wall scheme
  Precision precision = Precision::single_;
  rigid::Vec3 body_force = rigid::Vec3::Zero();  // acceleration of the fluid
  bool body_force_on_bodies = false;  // it stands for a pressure gradient, which pushes free bodies too
  // initial velocity: "rest", "uniform", "taylor-green", "taylor-green-3d"; amplitude and (for the vortices)
  // one wave a period
  std::string initial = "rest";
  rigid::Vec3 initial_velocity = rigid::Vec3::Zero();
};

}  // namespace silt::coupler
