#pragma once
// The fluid: the table [fluid] of a case.
#include "coupler/case/name_table.hpp"
#include "lbm/collision_model.hpp"
#include "rigid/math/types.hpp"

namespace silt::coupler {

enum class Precision { single_, double_ };
inline constexpr auto precision_names = names_of<Precision>("single", "double");

inline constexpr auto collision_names = [] {
  NameTable<lbm::Collision, lbm::collision_models.size()> table;
  for (std::size_t i = 0; i < table.names.size(); ++i) table.names[i] = lbm::collision_models[i].name;
  return table;
}();

/// The velocity of the fluid at the start: its amplitude and, of the vortices, one wave a period.
enum class InitialFlow { rest, uniform, taylor_green, taylor_green_3d };
inline constexpr auto initial_flow_names =
    names_of<InitialFlow>("rest", "uniform", "taylor-green", "taylor-green-3d");

struct FluidSpec {
  double kinematic_viscosity = 0, relaxation_time = 0;
  lbm::Collision collision = lbm::Collision::trt;
  double magic = 1. / 6;  // Lambda; with bodies or [[walls]] best_magic of the wall scheme
  Precision precision = Precision::single_;
  rigid::Vec3 body_force = rigid::Vec3::Zero();  // acceleration of the fluid
  bool body_force_on_bodies = false;  // it stands for a pressure gradient, which pushes free bodies too
  InitialFlow initial = InitialFlow::rest;
  rigid::Vec3 initial_velocity = rigid::Vec3::Zero();
};

}  // namespace silt::coupler
