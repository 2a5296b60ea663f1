#pragma once
// The coupler keeps this state with every body. rigid::BodySet carries it along as bytes: it travels from
// rank to rank and into checkpoints with the body. Lattice units, world frame.
#include <array>
#include <new>
#include <span>
#include <type_traits>
#include <vector>

#include "rigid/bodies/body_set.hpp"
#include "rigid/math/types.hpp"

namespace silt::coupler {

using Vec6 = Eigen::Matrix<double, 6, 1>;

/// A vector of a state: plain numbers, for Eigen's own vectors are not trivially copyable. One of 6 numbers
/// is a linear vector and an angular one, the latter about the centre of mass.
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

/// The fluid sees a body in this way in the steps [first, end) for which it was mapped: its cells at the pose
/// in the middle of them, its wall distances as if it moved past that pose with these velocities.
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
  /// Returns the pose `way` steps from the middle.
  rigid::Pose pose_after(double way) const {
    if (is_at_rest()) return pose();
    const rigid::Pose mapped = pose();
    return {mapped.position + way * velocity.linear(),
            rigid::cayley(way * velocity.angular()) * mapped.orientation};
  }
};

/// Mass that a body owes the fluid (forces/fluid_forces.cpp), in quanta of lbm::excess_quantum.
struct OwedMass {
  std::int64_t all = 0, by_each_link = 0;  // of `all` each link gives so much in the next step
};

/// Zero until it is set. Each member has its line in visit_columns.
struct CouplingState {
  MappedMotion mapped;
  // impulse and angular impulse about the centre of mass that the fluid has still to give the body, in quanta
  // of lbm::link_quantum
  std::array<std::int64_t, 6> impulse_debt = {};
  OwedMass mass_owed;
  // impulse that impacts gave to the fluid around the body, still to be passed on by the body
  Plain<3> pending_impact;
  // force and torque of its contacts in the last step: what the coupling in time expects of them in the next
  Plain<6> contact_load;
  // impulse and angular impulse that the coupling in time has left for the next step
  Plain<6> deferred_impulse;
  // change of velocity and angular velocity in the next step with which links return already
  Plain<6> foreseen_change;
  // velocity and angular velocity of a body with springs, had nothing else acted in the last step
  Plain<6> sprung_velocity;
  // for output: force and torque that the fluid had on the body when they were last evaluated, and those of
  // its springs in the last step
  Plain<6> seen_load, spring_load;
};
static_assert(std::is_trivially_copyable_v<CouplingState>);
static_assert(sizeof(CouplingState) == sizeof(rigid::HolderState),
              "HolderState::size is that of all members");

inline CouplingState& coupling_of(rigid::HolderState& held) {
  return *std::launder(reinterpret_cast<CouplingState*>(held.bytes));
}
inline const CouplingState& coupling_of(const rigid::HolderState& held) {
  return *std::launder(reinterpret_cast<const CouplingState*>(held.bytes));
}
inline CouplingState& coupling_of(rigid::BodySet& bodies, std::size_t row) {
  return coupling_of(bodies.holder_state[row]);
}
inline const CouplingState& coupling_of(const rigid::BodySet& bodies, std::size_t row) {
  return coupling_of(bodies.holder_state[row]);
}

struct CouplingColumn : rigid::BodyColumn {
  bool copied;  // copies on other ranks have what their owner has; else it is the owner's alone
  bool saved;   // in checkpoints
};

/// Calls visit(column, its numbers) for each column of a state, in the order of checkpoints.
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
}

inline rigid::Pose mapping_pose(const rigid::BodySet& bodies, std::size_t row) {
  return coupling_of(bodies, row).mapped.pose();
}
/// The fluid sees the body there, at rest, until that is said again.
inline void set_mapping_pose(rigid::BodySet& bodies, std::size_t row, const rigid::Pose& pose) {
  coupling_of(bodies, row).mapped = pose;
}

/// The load on a body in the last step is noted with it for output: it stays with the body if another rank
/// becomes its owner.
struct BodyLoad {
  rigid::Vec3 force = rigid::Vec3::Zero(), torque = rigid::Vec3::Zero();
};
using NotedLoad = Plain<6> CouplingState::*;

/// Returns what was noted of the owned bodies, by row.
inline std::vector<BodyLoad> noted_loads(const rigid::BodySet& bodies, NotedLoad noted) {
  std::vector<BodyLoad> loads;
  for (std::size_t row = 0; row < bodies.owned; ++row) {
    const auto& load = coupling_of(bodies, row).*noted;
    loads.push_back({load.linear(), load.angular()});
  }
  return loads;
}

/// Notes what acts on the owned bodies now, gravity apart.
inline void note_loads(rigid::BodySet& bodies) {
  for (std::size_t row = 0; row < bodies.owned; ++row)
    coupling_of(bodies, row).seen_load() << bodies.force[row].value(), bodies.torque[row].value();
}

/// Notes what contacts have given a body, of which the flow is told in the next step.
inline void add_contact_load(rigid::BodySet& bodies, std::size_t row, const rigid::Vec3& impulse,
                             const rigid::Vec3& angular_impulse) {
  auto& load = coupling_of(bodies, row).contact_load;
  load.linear() += impulse;
  load.angular() += angular_impulse;
}

/// Begins a step in which no contact has acted yet.
inline void forget_contact_loads(rigid::BodySet& bodies) {
  for (std::size_t row = 0; row < bodies.owned; ++row) coupling_of(bodies, row).contact_load = {};
}

/// The bodies that came and those that left before a step: the fluid takes note of both.
struct BodyChanges {
  rigid::BodyId first_new = 0, end_new = 0;  // ids from first_new on, below end_new, have come
  rigid::BodySet gone;                       // those that were held here and have left, as they were

  bool none() const { return first_new == end_new && gone.size() == 0; }
  bool is_new(rigid::BodyId id) const { return id >= first_new && id < end_new; }
  bool has_gone(rigid::BodyId id) const { return gone.row_of(id) < gone.size(); }
};

}  // namespace silt::coupler
