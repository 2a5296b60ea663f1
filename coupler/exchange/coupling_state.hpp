#pragma once
// The coupler keeps this state with every body, in columns that rigid::BodySet carries along: it travels from
// rank to rank and into checkpoints with the body. Lattice units, world frame.
#include "rigid/bodies/body_set.hpp"
#include "rigid/math/types.hpp"

namespace silt::coupler {

namespace column {
using rigid::HolderColumn;

// MappedMotion: pose, orientation w, x, y, z; velocity and angular velocity; steps
inline constexpr HolderColumn mapping_position{"mapping_position", HolderColumn::float64, 0, 3};
inline constexpr HolderColumn mapping_orientation = mapping_position.next("mapping_orientation", 4);
inline constexpr HolderColumn mapping_velocity = mapping_orientation.next("mapping_velocity", 6);
inline constexpr HolderColumn mapping_steps{"mapping_steps", HolderColumn::int64, 0, 2};
// change of velocity and angular velocity in the next step with which links return already
inline constexpr HolderColumn foreseen_change = mapping_velocity.next("foreseen_change", 6);
// impulse and angular impulse about the centre of mass that the fluid has still to give the body, in quanta
// of lbm::link_quantum
inline constexpr HolderColumn impulse_debt = mapping_steps.next("impulse_debt", 6);
// mass that the body owes the fluid (owed_mass.hpp), and what of it each link gives in the next step, in
// quanta of lbm::excess_quantum
inline constexpr HolderColumn mass_owed = impulse_debt.next("mass_owed", 2);
// impulse that impacts gave to the fluid around the body, still to be passed on by the body
inline constexpr HolderColumn pending_impact = foreseen_change.next("pending_impact", 3);
// impulse and angular impulse about the centre of mass that the coupling in time has left for the next step
inline constexpr HolderColumn deferred_impulse = pending_impact.next("deferred_impulse", 6);
// force and torque about the centre of mass of its contacts in the last step: what the coupling in time
// expects of them in the next one
inline constexpr HolderColumn contact_load = deferred_impulse.next("contact_load", 6);
// force and torque about the centre of mass that the fluid had on the body when they were last evaluated, for
// output
inline constexpr HolderColumn seen_load = contact_load.next("seen_load", 6);
// velocity and angular velocity of a body with springs, had nothing else acted in the last step
inline constexpr HolderColumn sprung_velocity = seen_load.next("sprung_velocity", 6);
// force and torque about the centre of mass of its springs in the last step, for output
inline constexpr HolderColumn spring_load = sprung_velocity.next("spring_load", 6);
static_assert(spring_load.end() == rigid::HolderState::most_numbers);
static_assert(mass_owed.end() == rigid::HolderState::most_integers);

/// Copies on other ranks have what their owner has in these columns; the rest is the owner's alone.
inline constexpr HolderColumn copied[] = {mapping_position, mapping_orientation, mapping_velocity,
                                          mapping_steps,    foreseen_change,     mass_owed};
/// These columns are in checkpoints.
inline constexpr HolderColumn saved[] = {
    mapping_position, mapping_orientation, mapping_velocity, mapping_steps,   impulse_debt,   mass_owed,
    pending_impact,   contact_load,        deferred_impulse, foreseen_change, sprung_velocity};
}  // namespace column

/// A vector of a column, from its k-th number on.
template <int n>
auto vector_in(rigid::BodySet& bodies, std::size_t row, const rigid::HolderColumn& column, int k = 0) {
  return Eigen::Map<Eigen::Matrix<double, n, 1>>{bodies.holder_state[row][column].data() + k};
}
template <int n>
auto vector_in(const rigid::BodySet& bodies, std::size_t row, const rigid::HolderColumn& column, int k = 0) {
  return Eigen::Map<const Eigen::Matrix<double, n, 1>>{bodies.holder_state[row][column].data() + k};
}

/// The fluid sees a body in this way in the steps [first, end) for which it was mapped: its cells at the pose
/// in the middle of them, its wall distances as if it moved past that pose with these velocities.
struct MappedMotion {
  rigid::Pose pose;
  rigid::Vec3 velocity = rigid::Vec3::Zero(), angular_velocity = rigid::Vec3::Zero();
  std::int64_t first = 0, end = 0;

  double middle() const { return 0.5 * static_cast<double>(first + end - 1); }
  bool is_at_rest() const { return velocity.isZero(0) && angular_velocity.isZero(0); }
  /// Returns the pose so many steps from the middle.
  rigid::Pose pose_after(double steps) const {
    if (is_at_rest()) return pose;
    return {pose.position + steps * velocity, rigid::cayley(steps * angular_velocity) * pose.orientation};
  }
};

inline rigid::Pose mapping_pose(const rigid::BodySet& bodies, std::size_t row) {
  const auto q = vector_in<4>(bodies, row, column::mapping_orientation);
  return {vector_in<3>(bodies, row, column::mapping_position), {q[0], q[1], q[2], q[3]}};
}

inline MappedMotion mapped_motion(const rigid::BodySet& bodies, std::size_t row) {
  const auto steps = bodies.holder_state[row].whole(column::mapping_steps);
  return {mapping_pose(bodies, row), vector_in<3>(bodies, row, column::mapping_velocity),
          vector_in<3>(bodies, row, column::mapping_velocity, 3), steps[0], steps[1]};
}

inline void set_mapped_motion(rigid::BodySet& bodies, std::size_t row, const MappedMotion& mapped) {
  const rigid::Quat& q = mapped.pose.orientation;
  vector_in<3>(bodies, row, column::mapping_position) = mapped.pose.position;
  vector_in<4>(bodies, row, column::mapping_orientation) = Eigen::Vector4d(q.w(), q.x(), q.y(), q.z());
  vector_in<3>(bodies, row, column::mapping_velocity) = mapped.velocity;
  vector_in<3>(bodies, row, column::mapping_velocity, 3) = mapped.angular_velocity;
  const auto steps = bodies.holder_state[row].whole(column::mapping_steps);
  steps[0] = mapped.first, steps[1] = mapped.end;
}

/// The fluid sees the body there, at rest, until that is said again.
inline void set_mapping_pose(rigid::BodySet& bodies, std::size_t row, const rigid::Pose& pose) {
  set_mapped_motion(bodies, row, {pose});
}

using Vec6 = Eigen::Matrix<double, 6, 1>;

inline auto foreseen_change(rigid::BodySet& bodies, std::size_t row) {
  return vector_in<6>(bodies, row, column::foreseen_change);
}
inline std::span<std::int64_t> mass_owed(rigid::BodySet& bodies, std::size_t row) {
  return bodies.holder_state[row].whole(column::mass_owed);
}
inline auto deferred_impulse(rigid::BodySet& bodies, std::size_t row) {
  return vector_in<6>(bodies, row, column::deferred_impulse);
}
inline auto pending_impact(rigid::BodySet& bodies, std::size_t row) {
  return vector_in<3>(bodies, row, column::pending_impact);
}
inline auto pending_impact(const rigid::BodySet& bodies, std::size_t row) {
  return vector_in<3>(bodies, row, column::pending_impact);
}

/// The load on a body in the last step is noted with it for output: it stays with the body if another rank
/// becomes its owner.
struct BodyLoad {
  rigid::Vec3 force = rigid::Vec3::Zero(), torque = rigid::Vec3::Zero();
};

/// Returns what was noted of the owned bodies in a column, by row.
inline std::vector<BodyLoad> noted_loads(const rigid::BodySet& bodies, const rigid::HolderColumn& noted) {
  std::vector<BodyLoad> loads;
  for (std::size_t row = 0; row < bodies.owned; ++row)
    loads.push_back({vector_in<3>(bodies, row, noted), vector_in<3>(bodies, row, noted, 3)});
  return loads;
}

/// Notes what acts on the owned bodies now, gravity apart.
inline void note_loads(rigid::BodySet& bodies) {
  for (std::size_t row = 0; row < bodies.owned; ++row)
    vector_in<6>(bodies, row, column::seen_load) << bodies.force[row].value(), bodies.torque[row].value();
}

/// Notes what contacts have given a body, of which the flow is told in the next step.
inline void add_contact_load(rigid::BodySet& bodies, std::size_t row, const rigid::Vec3& impulse,
                             const rigid::Vec3& angular_impulse) {
  vector_in<3>(bodies, row, column::contact_load) += impulse;
  vector_in<3>(bodies, row, column::contact_load, 3) += angular_impulse;
}

/// Begins a step in which no contact has acted yet.
inline void forget_contact_loads(rigid::BodySet& bodies) {
  for (std::size_t row = 0; row < bodies.owned; ++row)
    vector_in<6>(bodies, row, column::contact_load).setZero();
}

}  // namespace silt::coupler
