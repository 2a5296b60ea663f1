#pragma once
// What the coupler keeps with every body, in the bytes that rigid::BodySet carries along: it travels from
// rank to rank and into checkpoints with the body.
#include "rigid/bodies/body_set.hpp"

namespace silt::coupler {

/// Lattice units, world frame. Copies on other ranks have the mapping pose and the foreseen change of their
/// owner; the rest is the owner's alone.
struct CouplingState {
  // the pose at which the fluid sees the body; orientation w, x, y, z
  double mapping_position[3], mapping_orientation[4];
  // impulse and angular impulse about the centre of mass that the fluid has still to give the body, in quanta
  // of lbm::link_quantum
  std::int64_t impulse_debt[6];
  // impulse that impacts gave to the fluid around the body, still to be passed on by the body
  double pending_impact[3];
  // force and torque about the centre of mass that the fluid had on the body when they were last evaluated,
  // for output; not in checkpoints
  double seen_load[6];
  // force and torque about the centre of mass of its contacts in the last step: what the coupling in time
  // expects of them in the next one
  double contact_load[6];
  // impulse and angular impulse about the centre of mass that the coupling in time has left for the next step
  double deferred_impulse[6];
  // change of velocity and angular velocity in the next step with which links return already; copies have it
  double foreseen_change[6];
};
static_assert(sizeof(CouplingState) == rigid::HolderState::size);

inline CouplingState& coupling_state(rigid::BodySet& bodies, std::size_t row) {
  return bodies.holder_state[row].as<CouplingState>();
}
inline const CouplingState& coupling_state(const rigid::BodySet& bodies, std::size_t row) {
  return bodies.holder_state[row].as<CouplingState>();
}

inline rigid::Pose mapping_pose(const rigid::BodySet& bodies, std::size_t row) {
  const CouplingState& s = coupling_state(bodies, row);
  const double *x = s.mapping_position, *q = s.mapping_orientation;
  return {{x[0], x[1], x[2]}, {q[0], q[1], q[2], q[3]}};
}

inline void set_mapping_pose(rigid::BodySet& bodies, std::size_t row, const rigid::Pose& pose) {
  CouplingState& s = coupling_state(bodies, row);
  const rigid::Quat& q = pose.orientation;
  Eigen::Map<rigid::Vec3>{s.mapping_position} = pose.position;
  Eigen::Map<Eigen::Vector4d>{s.mapping_orientation} = Eigen::Vector4d(q.w(), q.x(), q.y(), q.z());
}

using Vec6 = Eigen::Matrix<double, 6, 1>;

inline Eigen::Map<Vec6> foreseen_change(rigid::BodySet& bodies, std::size_t row) {
  return Eigen::Map<Vec6>{coupling_state(bodies, row).foreseen_change};
}
inline Eigen::Map<Vec6> deferred_impulse(rigid::BodySet& bodies, std::size_t row) {
  return Eigen::Map<Vec6>{coupling_state(bodies, row).deferred_impulse};
}

inline rigid::Vec3 last_contact_force(const rigid::BodySet& bodies, std::size_t row) {
  return Eigen::Map<const rigid::Vec3>{coupling_state(bodies, row).contact_load};
}

inline rigid::Vec3 last_contact_torque(const rigid::BodySet& bodies, std::size_t row) {
  return Eigen::Map<const rigid::Vec3>{coupling_state(bodies, row).contact_load + 3};
}

inline Eigen::Map<rigid::Vec3> pending_impact(rigid::BodySet& bodies, std::size_t row) {
  return Eigen::Map<rigid::Vec3>{coupling_state(bodies, row).pending_impact};
}
inline rigid::Vec3 pending_impact(const rigid::BodySet& bodies, std::size_t row) {
  return Eigen::Map<const rigid::Vec3>{coupling_state(bodies, row).pending_impact};
}

}  // namespace silt::coupler
