#pragma once
// The state that the coupler keeps with every body, as bytes in rigid::BodySet: it travels with the body
// between ranks and into checkpoints. Lattice units, world frame.
#include <array>
#include <type_traits>
#include <vector>

#include "rigid/bodies/body_set.hpp"
#include "rigid/math/types.hpp"

namespace silt::coupler {

using Vec6 = Eigen::Matrix<double, 6, 1>;

/// A vector of plain numbers, trivially copyable unlike Eigen's. One of 6 has a linear and an angular part,
/// the latter about the centre of mass.
template <int n>
struct Plain {
  double numbers[n] = {};

  auto operator()() { return Eigen::Map<Eigen::Matrix<double, n, 1>>(numbers); }
  auto operator()() const { return Eigen::Map<const Eigen::Matrix<double, n, 1>>(numbers); }
  auto linear() requires(n == 6) { return Eigen::Map<rigid::Vec3>(numbers); }
  auto linear() const requires(n == 6) { return Eigen::Map<const rigid::Vec3>(numbers); }
  auto angular() requires(n == 6) { return Eigen::Map<rigid::Vec3>(numbers + 3); }
  auto angular() const requires(n == 6) { return Eigen::Map<const rigid::Vec3>(numbers + 3); }
};

/// The motion by which the fluid sees a body in the steps [first, end) of a mapping: its cells are those of
/// the pose in the middle, its wall distances change as if it passed that pose with these velocities.
struct MappedMotion {
  Plain<3> position;
  Plain<4> orientation;  // w, x, y, z
  Plain<6> velocity;
  struct {
    std::int64_t first = 0, end = 0;
  } steps;

  MappedMotion() = default;
  MappedMotion(const rigid::Pose& pose, const rigid::Vec3& v = rigid::Vec3::Zero(),
               const rigid::Vec3& w = rigid::Vec3::Zero(), std::int64_t first = 0, std::int64_t end = 0)
      : steps{first, end} {
    set_pose(pose);
    velocity() << v, w;
  }
  rigid::Pose pose() const {
    const double* const q = orientation.numbers;
    return {position(), {q[0], q[1], q[2], q[3]}};
  }
  void set_pose(const rigid::Pose& pose) {
    const rigid::Quat& q = pose.orientation;
    position() = pose.position;
    orientation() << q.w(), q.x(), q.y(), q.z();
  }
  double middle() const { return 0.5 * static_cast<double>(steps.first + steps.end - 1); }
  bool is_at_rest() const { return velocity().isZero(0); }
  /// Returns the pose `way` steps after the middle.
  rigid::Pose pose_after(double way) const {
    if (is_at_rest()) return pose();
    const rigid::Pose mapped = pose();
    return {mapped.position + way * velocity.linear(),
            rigid::cayley(way * velocity.angular()) * mapped.orientation};
  }
};

/// Mass that a body owes the fluid (forces/fluid_forces.cpp), in units of lbm::excess_quantum.
struct OwedMass {
  std::int64_t all = 0, by_each_link = 0;  // in total; the part of it that each link returns in the next step
};

/// Heat that a body has received and not stored, in lbm::heat_quantum (heat/heat_flow.cpp); the part of it
/// that each link of an insulating body returns in the next step.
struct OwedHeat {
  std::int64_t all = 0, by_each_link = 0;
};

/// The whole state, initially zero. Every member has a line in visit_columns.
struct CouplingState {
  MappedMotion mapped;
  // impulse and angular impulse that the fluid still owes the body, in units of lbm::link_quantum
  std::array<std::int64_t, 6> impulse_debt = {};
  OwedMass mass_owed;
  // impulse that impacts gave to the fluid around the body, which the body has yet to pass on
  Plain<3> pending_impact;
  // force and torque of its contacts in the last step, which the coupling in time expects again
  Plain<6> contact_load;
  // impulse and angular impulse that the coupling in time deferred to the next step
  Plain<6> deferred_impulse;
  // predicted change of velocity and angular velocity in the next step, which links already take into account
  Plain<6> foreseen_change;
  // velocity and angular velocity of a body with springs if nothing else had acted in the last step
  Plain<6> sprung_velocity;
  // for output: the last force and torque of the fluid on the body, and those of its springs
  Plain<6> seen_load, spring_load;
  // temperature of a body with a heat capacity, relative to the reference; heat that it receives from the
  // fluid in a step, over the steps in which heat crosses a cell (heat/heat_flow.cpp)
  Plain<1> temperature, heat_flow;
  OwedHeat heat_owed;
};
static_assert(std::is_trivially_copyable_v<CouplingState>);
static_assert(sizeof(CouplingState) == sizeof(rigid::AttachedState),
              "AttachedState::size is that of all members");

inline CouplingState& coupling_of(rigid::AttachedState& held) {
  return *std::launder(reinterpret_cast<CouplingState*>(held.bytes));
}
inline const CouplingState& coupling_of(const rigid::AttachedState& held) {
  return *std::launder(reinterpret_cast<const CouplingState*>(held.bytes));
}
inline CouplingState& coupling_of(rigid::BodySet& bodies, std::size_t row) {
  return coupling_of(bodies.attached_state[row]);
}
inline const CouplingState& coupling_of(const rigid::BodySet& bodies, std::size_t row) {
  return coupling_of(bodies.attached_state[row]);
}

struct CouplingColumn : rigid::BodyColumn {
  bool copied;  // copies have their owner's value; otherwise only the owner has it
  bool saved;   // in checkpoints
};

/// Calls visit(column, its numbers) for each column in the order of checkpoints.
template <class Visit>
void visit_columns(const CouplingState& s, Visit&& visit) {
  using enum rigid::Values;
  constexpr bool copied = true, saved = true;
  const auto column = [&]<class Member>(const char* name, rigid::Values values, bool is_copied, bool is_saved,
                                        const Member& member) {
    constexpr bool is_vector = std::is_same_v<Member, Plain<int(sizeof(Member) / sizeof(double))>>;
    using Number = std::conditional_t<is_vector, double, std::int64_t>;
    visit(CouplingColumn{{name, values}, is_copied, is_saved}, rigid::numbers_of<Number>(member));
  };
  column("mapping_position", place, copied, saved, s.mapped.position);
  column("mapping_orientation", orientation, copied, saved, s.mapped.orientation);
  column("mapping_velocity", velocity, copied, saved, s.mapped.velocity);
  column("mapping_steps", step, copied, saved, s.mapped.steps);
  column("impulse_debt", quanta, !copied, saved, s.impulse_debt);
  column("mass_owed", quanta, copied, saved, s.mass_owed);
  column("pending_impact", impulse, !copied, saved, s.pending_impact);
  column("contact_load", impulse, !copied, saved, s.contact_load);
  column("deferred_impulse", impulse, !copied, saved, s.deferred_impulse);
  column("foreseen_change", velocity, copied, saved, s.foreseen_change);
  column("sprung_velocity", velocity, !copied, saved, s.sprung_velocity);
  column("seen_load", impulse, !copied, !saved, s.seen_load);
  column("spring_load", impulse, !copied, !saved, s.spring_load);
  column("temperature", heat, copied, saved, s.temperature);
  column("heat_flow", heat, !copied, saved, s.heat_flow);
  column("heat_owed", quanta, copied, saved, s.heat_owed);
}

inline rigid::Pose mapping_pose(const rigid::BodySet& bodies, std::size_t row) {
  return coupling_of(bodies, row).mapped.pose();
}
/// From now on the fluid sees the body at this pose, at rest.
inline void set_mapping_pose(rigid::BodySet& bodies, std::size_t row, const rigid::Pose& pose) {
  coupling_of(bodies, row).mapped = pose;
}

/// A load on a body in the last step, stored with the body for output, even if the owner changes.
struct BodyLoad {
  rigid::Vec3 force = rigid::Vec3::Zero(), torque = rigid::Vec3::Zero();
};
using StoredLoad = Plain<6> CouplingState::*;

/// Returns a stored load of the owned bodies, by row.
inline std::vector<BodyLoad> stored_loads(const rigid::BodySet& bodies, StoredLoad noted) {
  std::vector<BodyLoad> loads;
  for (std::size_t row = 0; row < bodies.owned; ++row) {
    const auto& load = coupling_of(bodies, row).*noted;
    loads.push_back({load.linear(), load.angular()});
  }
  return loads;
}

/// Stores the current forces on the owned bodies, without gravity.
inline void store_loads(rigid::BodySet& bodies) {
  for (std::size_t row = 0; row < bodies.owned; ++row)
    coupling_of(bodies, row).seen_load() << bodies.force[row].value(), bodies.torque[row].value();
}

/// Adds an impulse of contacts, which the coupling uses in the next step.
inline void add_contact_load(rigid::BodySet& bodies, std::size_t row, const rigid::Vec3& impulse,
                             const rigid::Vec3& angular_impulse) {
  auto& load = coupling_of(bodies, row).contact_load;
  load.linear() += impulse;
  load.angular() += angular_impulse;
}

/// Clears the contact loads at the start of a step.
inline void clear_contact_loads(rigid::BodySet& bodies) {
  for (std::size_t row = 0; row < bodies.owned; ++row) coupling_of(bodies, row).contact_load = {};
}

/// The bodies that entered or left before a step, for the fluid.
struct BodyChanges {
  rigid::BodyId first_new = 0, end_new = 0;  // new bodies have the ids [first_new, end_new)
  rigid::BodySet gone;                       // last states of the bodies of this rank that have left

  bool none() const { return first_new == end_new && gone.size() == 0; }
  bool is_new(rigid::BodyId id) const { return id >= first_new && id < end_new; }
  bool has_gone(rigid::BodyId id) const { return gone.row_of(id) < gone.size(); }
};

}  // namespace silt::coupler
