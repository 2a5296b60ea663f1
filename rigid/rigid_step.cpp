#include "rigid/rigid_step.hpp"

#include <algorithm>
#include <cstring>

namespace silt::rigid {
namespace {

void clear_forces(BodySet& bodies) {
  std::fill(bodies.force.begin(), bodies.force.end(), FixedVec3{});
  std::fill(bodies.torque.begin(), bodies.torque.end(), FixedVec3{});
}

/// Returns whether any is nonzero: all bytes are zero if the first is and each equals its predecessor.
bool any_nonzero(const std::vector<FixedVec3>& sums) {
  static_assert(std::has_unique_object_representations_v<FixedVec3>);
  const auto* const bytes = reinterpret_cast<const unsigned char*>(sums.data());
  const std::size_t size = sums.size() * sizeof(FixedVec3);
  return size > 0 && (bytes[0] != 0 || std::memcmp(bytes, bytes + 1, size - 1) != 0);
}

/// Each contact is counted once, by the owner of the body of the lower id.
std::uint64_t mixed_owner_contacts(const BodySet& bodies, const std::vector<Contact>& contacts) {
  if (bodies.copies + bodies.visitors == 0) return 0;
  return std::ranges::count_if(contacts, [&](const Contact& c) {
    return !is_wall(c.b) && bodies.row_of(c.a) < bodies.owned && bodies.row_of(c.b) >= bodies.owned;
  });
}

}  // namespace

RigidStep::RigidStep(const World& world, CollisionBackend& backend, ContactResolver& resolver,
                     BodyExchange& exchange, std::unique_ptr<BroadPhase> broad_phase)
    : world_(world),
      backend_(backend),
      resolver_(resolver),
      exchange_(exchange),
      clock_([] { return parallel::traffic(); }),
      detect_contacts_(std::move(broad_phase)) {
  velocities_.start = true;
}

RigidStepReport RigidStep::operator()(BodySet& bodies, double dt) {
  return substep(bodies, dt, true);
}

RigidStepReport RigidStep::advance(BodySet& bodies, int substeps) {
  RigidStepReport report;
  for (int i = 1; i <= substeps; ++i) report += substep(bodies, 1.0 / substeps, i == substeps);
  return report;
}

/// Algorithm 1 with the equation numbers of method.md. Lines 1 and 6 need no message: forces act on owned
/// rows only, and copies drift here bitwise as they do at their owners.
RigidStepReport RigidStep::substep(BodySet& bodies, double dt, bool last) {
  RigidStepReport report;
  using enum RigidStage;
  RigidClock::Scope stage(clock_, integrate);
  if (!holds_poses_) drift(bodies, bodies.owned + bodies.copies, 0.5 * dt);  // lines 2-6, positions (M1)
  exchange_.wrap_positions(bodies);
  stage.switch_to(collision_detection);
  report.pairs = detect_contacts_(world_, bodies, exchange_, backend_, dt, contacts_);  // lines 7-12
  report.lubrication = detect_contacts_.lubrication();
  stage.switch_to(synchronisation);
  exchange_.exchange_contacts(bodies, contacts_);  // line 13
  report.mixed_owner_contacts = mixed_owner_contacts(bodies, contacts_);
  stage.switch_to(integrate);
  kick_before_contacts(bodies, dt);  // lines 2-5, velocities (M2)
  stage.switch_to(contact_response);
  velocities_.wants_all_impulses = observer_ && observer_->wants_all_impulses();
  velocities_.other_impulses.clear();
  report.resolver = resolver_.resolve(bodies, contacts_, dt, velocities_, exchange_);  // lines 14-20 (M3)
  velocities_.start = false;
  stage.switch_to(integrate);
  finish(bodies, dt, last);  // lines 21-22 (M4)
  stage.switch_to(synchronisation);
  exchange_.synchronise(bodies);  // line 23
  return report;
}

/// The second half of the drift, with the velocities after the contacts.
void RigidStep::finish(BodySet& bodies, double dt, bool last) {
  apply_velocities(bodies, dt);
  if (last && forced_) clear_forces(bodies);
  if (observer_) observer_->before_drift(bodies);
  if (holds_poses_) return;
  apply_position_correction(bodies, dt);
  drift(bodies, bodies.owned, 0.5 * dt);
}

void RigidStep::find_rows_in_contact(const BodySet& bodies) {
  std::vector<std::size_t>& rows = velocities_.rows;
  in_contact_.assign(bodies.size(), 0);
  rows.clear();
  const auto add = [&](std::size_t row) {
    if (in_contact_[row]) return;
    in_contact_[row] = 1;
    rows.push_back(row);
  };
  for (std::size_t k = 0; k < contacts_.size(); ++k) {
    const Contact& c = contacts_[k];
    if (k > 0 && c.pair() == contacts_[k - 1].pair()) continue;
    if (k == 0 || c.a != contacts_[k - 1].a) add(bodies.row_of(c.a));
    add(bodies.row_of(c.b));
  }
}

/// Applies gravity and external forces; velocities_ stores both velocities of bodies in contact.
void RigidStep::kick_before_contacts(BodySet& bodies, double dt) {
  find_rows_in_contact(bodies);
  StepVelocities& velocities = velocities_;
  for (auto* all : {&velocities.before, &velocities.now}) all->resize(bodies.size());
  if (resolver_.first_kick() < 1) velocities.misses_kick.assign(bodies.size(), 0);
  for (const std::size_t row : velocities.rows) velocities.before[row] = bodies.twist(row);
  if (!world_.gravity.isZero(0))
    for (std::size_t row = 0; row < bodies.owned; ++row)
      if (bodies.is_dynamic(row))
        bodies.velocity[row] += bodies.unlocked(row, (dt * bodies.weight_in_fluid[row]) * world_.gravity);
  forced_ = any_nonzero(bodies.force) || any_nonzero(bodies.torque);
  if (forced_)
    for (std::size_t row = 0; row < bodies.owned; ++row)
      if (bodies.is_dynamic(row)) kick(bodies, row, resolver_.first_kick() * dt);
  for (const std::size_t row : velocities.rows) velocities.now[row] = bodies.twist(row);
}

/// Applies force and torque to one body over dt.
void RigidStep::kick(BodySet& bodies, std::size_t row, double dt) const {
  if (!bodies.force[row].is_zero())
    bodies.velocity[row] += bodies.unlocked(row, (dt / bodies.mass[row]) * bodies.force[row].value());
  if (bodies.torque[row].is_zero()) return;
  const LockedAxes about = bodies.locked(row) >> 3;
  const Vec3 torque = without_locked(about, bodies.torque[row].value());
  bodies.angular_momentum[row] += dt * torque;
  bodies.angular_velocity[row] += dt * (bodies.inverse_inertia_W(row) * torque);
}

/// Copies the resolver's velocities to the bodies and applies the remaining part of the kick (ffd).
void RigidStep::apply_velocities(BodySet& bodies, double dt) {
  StepObserver* const observer = observer_ && observer_->wants_contact_impulses() ? observer_ : nullptr;
  for (const std::size_t row : velocities_.rows) {
    if (row >= bodies.owned || !bodies.is_dynamic(row)) continue;
    const auto& [v, w] = velocities_.now[row];
    const Vec3 contacts = w - bodies.angular_velocity[row];
    Vec3 angular_impulse = Vec3::Zero();
    if (contacts != Vec3::Zero()) {
      const Mat3 r = bodies.orientation[row].toRotationMatrix();
      angular_impulse = r * (bodies.inertia_B[row] * (r.transpose() * contacts));
      bodies.angular_momentum[row] += angular_impulse;
    }
    if (observer && !bodies.locked(row))
      observer->contact_impulse(bodies, row, bodies.mass[row] * (v - bodies.velocity[row]), angular_impulse);
    bodies.velocity[row] = v;
    bodies.angular_velocity[row] = w;
  }
  for (const ContactSum& sum : velocities_.on_locked)
    if (observer && sum.row < bodies.owned)
      observer->contact_impulse(bodies, sum.row, sum.impulse, sum.moment);
  const double share = 1 - resolver_.first_kick();
  if (share == 0) return;
  for (std::size_t row = 0; row < bodies.owned; ++row)
    if (bodies.is_dynamic(row) && !velocities_.misses_kick[row]) kick(bodies, row, share * dt);
}

/// Applies the split impulses, which separate overlapping bodies without changing their velocities.
void RigidStep::apply_position_correction(BodySet& bodies, double dt) const {
  if (velocities_.push.empty()) return;
  for (const std::size_t row : velocities_.rows) {
    if (row >= bodies.owned || !bodies.is_dynamic(row)) continue;
    const auto& [shift, turn] = velocities_.push[row];
    bodies.position[row] += dt * shift;
    if (turn != Vec3::Zero())
      bodies.orientation[row] = (rotation_by(dt * turn) * bodies.orientation[row]).normalized();
  }
}

namespace {

Mat3 cross_matrix(const Vec3& a) {
  Mat3 m;
  m << 0, -a[2], a[1], a[2], 0, -a[0], -a[1], a[0], 0;
  return m;
}

/// Solves matrix x = right by Cramer's rule.
Vec3 solution(const Mat3& matrix, const Vec3& right) {
  const Vec3 a = matrix.col(0), b = matrix.col(1), c = matrix.col(2), b_c = b.cross(c);
  return Vec3(right.dot(b_c), a.dot(right.cross(c)), a.dot(b.cross(right))) / a.dot(b_c);
}

/// Restores unit length, lost to rounding, without a square root.
Quat renormalised(const Quat& q) {
  return Quat((1.5 - 0.5 * q.squaredNorm()) * q.coeffs());
}

/// Solves for the midpoint angular velocity in the body frame by Newton's method, to round-off.
Vec3 midpoint_angular_velocity(const Mat3& inverse, const Vec3& start, double h) {
  constexpr int cap = 20;              // quadratic convergence: 4 is usual
  constexpr double round_off = 4e-16;  // relative to |L|
  const double length = start.norm();
  Vec3 end = start, mean = start, omega = inverse * start;
  for (int i = 0; i < cap && length > 0; ++i) {
    const Vec3 residual = end - start - h * mean.cross(omega);
    if (residual.norm() <= round_off * length && i > 0) break;
    const Mat3 slope = Mat3::Identity() - 0.5 * h * (cross_matrix(mean) * inverse - cross_matrix(omega));
    end -= solution(slope, residual);
    mean = 0.5 * (start + end);
    omega = inverse * mean;
  }
  return omega;
}

Quat rotated_freely(const Quat& q, const Mat3& inverse_inertia_B, const Vec3& momentum_B, double h) {
  return renormalised(q * cayley(h * midpoint_angular_velocity(inverse_inertia_B, momentum_B, h)));
}

void drift_free(BodySet& b, std::size_t row, double h) {
  b.position[row] += h * b.velocity[row];
  const Vec3& momentum = b.angular_momentum[row];
  if (b.locked(row) & locked_rotations) {
    b.angular_velocity[row] = b.inverse_inertia_W(row) * momentum;
    b.orientation[row] = (rotation_by(h * b.angular_velocity[row]) * b.orientation[row]).normalized();
    return;
  }
  if (momentum.squaredNorm() == 0) {
    b.angular_velocity[row].setZero();
    return;
  }
  if (b.is_isotropic(row)) {  // omega is constant, and parallel to L
    b.angular_velocity[row] = momentum / b.inertia_B[row](0, 0);
    b.orientation[row] = renormalised(cayley(h * b.angular_velocity[row]) * b.orientation[row]);
    return;
  }
  const Mat3 inverse = b.inertia_B[row].inverse();
  Quat& q = b.orientation[row];
  q = rotated_freely(q, inverse, q.conjugate() * momentum, h);
  b.angular_velocity[row] = q * Vec3(inverse * (q.conjugate() * momentum));
}

}  // namespace

Quat free_rotation(const Quat& q, const Mat3& inertia_B, const Vec3& angular_momentum_W, double h) {
  return rotated_freely(q, inertia_B.inverse(), q.conjugate() * angular_momentum_W, h);
}

void drift(BodySet& b, std::size_t rows, double h) {
  for (std::size_t row = 0; row < rows; ++row) {
    if (b.is_dynamic(row)) {
      drift_free(b, row, h);
    } else if (b.motion[row] == Motion::prescribed) {
      b.position[row] += h * b.velocity[row];
      b.orientation[row] = (rotation_by(h * b.angular_velocity[row]) * b.orientation[row]).normalized();
    }
  }
}

}  // namespace silt::rigid
