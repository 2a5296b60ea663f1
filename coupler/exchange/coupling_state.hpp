#pragma once
// What the coupler keeps with every body, in the bytes that rigid::BodySet carries along: it travels from
// rank to rank and into checkpoints with the body.
#include "rigid/bodies/body_set.hpp"
#include "rigid/math/twist.hpp"

namespace silt::coupler {

/// Lattice units, world frame. Copies on other ranks have the mapped motion and the foreseen change of their
/// owner; the rest is the owner's alone.
struct CouplingState {
  // MappedMotion: pose, orientation w, x, y, z; velocity and angular velocity; steps
  double mapping_position[3], mapping_orientation[4], mapping_velocity[6];
  std::int64_t mapping_steps[2];
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

/// How the fluid sees a body in the steps [first, end) for which it was mapped: its cells at the pose in the
/// middle of them, its wall distances as if it moved past that pose with these velocities.
struct MappedMotion {
  rigid::Pose pose;
  rigid::Vec3 velocity = rigid::Vec3::Zero(), angular_velocity = rigid::Vec3::Zero();
  std::int64_t first = 0, end = 0;

  double middle() const { return 0.5 * static_cast<double>(first + end - 1); }
  bool is_at_rest() const { return velocity.isZero(0) && angular_velocity.isZero(0); }
  /// So many steps from the middle.
  rigid::Pose pose_after(double steps) const {
    if (is_at_rest()) return pose;
    return {pose.position + steps * velocity, rigid::cayley(steps * angular_velocity) * pose.orientation};
  }
};

inline rigid::Pose mapping_pose(const rigid::BodySet& bodies, std::size_t row) {
  const CouplingState& s = coupling_state(bodies, row);
  const double *x = s.mapping_position, *q = s.mapping_orientation;
  return {{x[0], x[1], x[2]}, {q[0], q[1], q[2], q[3]}};
}

inline MappedMotion mapped_motion(const rigid::BodySet& bodies, std::size_t row) {
  const CouplingState& s = coupling_state(bodies, row);
  const double* v = s.mapping_velocity;
  return {mapping_pose(bodies, row),
          {v[0], v[1], v[2]},
          {v[3], v[4], v[5]},
          s.mapping_steps[0],
          s.mapping_steps[1]};
}

inline void set_mapped_motion(rigid::BodySet& bodies, std::size_t row, const MappedMotion& mapped) {
  CouplingState& s = coupling_state(bodies, row);
  const rigid::Quat& q = mapped.pose.orientation;
  Eigen::Map<rigid::Vec3>{s.mapping_position} = mapped.pose.position;
  Eigen::Map<Eigen::Vector4d>{s.mapping_orientation} = Eigen::Vector4d(q.w(), q.x(), q.y(), q.z());
  Eigen::Map<rigid::Vec3>{s.mapping_velocity} = mapped.velocity;
  Eigen::Map<rigid::Vec3>{s.mapping_velocity + 3} = mapped.angular_velocity;
  s.mapping_steps[0] = mapped.first, s.mapping_steps[1] = mapped.end;
}

/// The fluid sees the body there, at rest, until that is said anew.
inline void set_mapping_pose(rigid::BodySet& bodies, std::size_t row, const rigid::Pose& pose) {
  set_mapped_motion(bodies, row, {pose});
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
