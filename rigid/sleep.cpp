#include "rigid/sleep.hpp"

namespace silt::rigid {
namespace {

/// Bodies wake by more than keeps them from falling asleep: else they would do both in turn.
constexpr double hysteresis = 2;

void hold(BodySet& bodies, std::size_t row) {
  bodies.velocity[row].setZero();
  bodies.angular_velocity[row].setZero();
  bodies.angular_momentum[row].setZero();
  bodies.wakefulness[row] = Wakefulness::falling_asleep;
  bodies.rest[row] = {};
}

/// Returns the angular velocity that an angular impulse would give to a body that is held.
Vec3 angular_velocity_by(const BodySet& bodies, std::size_t row, const Vec3& impulse) {
  const Mat3& inertia = bodies.inertia_B[row];
  if (bodies.is_isotropic(row)) return impulse / inertia(0, 0);
  const Mat3 to_world = bodies.orientation[row].toRotationMatrix();
  return to_world * (inertia.inverse() * (to_world.transpose() * impulse));
}

}  // namespace

double Sleep::surface_speed(const BodySet& bodies, std::size_t row, const Twist& t) const {
  return t.v.norm() + world_.bounding_radii[bodies.shape[row]] * t.w.norm();
}

/// A body that moves by itself always comes upon the other.
bool Sleep::comes_upon(const BodySet& bodies, const Contact& c, double dt) const {
  const std::size_t a = bodies.row_of(c.a), b = bodies.row_of(c.b);
  if (bodies.motion[a] == Motion::prescribed || bodies.motion[b] == Motion::prescribed) return true;
  const double opening = c.normal.dot(bodies.velocity_at(b, c.r_b) - bodies.velocity_at(a, c.r_a));
  return opening < -world_.sleep->speed && c.gap + dt * opening < 0;
}

void Sleep::wake_what_is_hit(BodySet& bodies, const std::vector<Contact>& contacts, double dt,
                             BodyExchange& exchange) {
  if (!world_.sleep) return;
  for (const Contact& c : contacts)
    for (const BodyId id : {c.a, c.b}) {
      const std::size_t row = bodies.row_of(id);
      if (row < bodies.owned && bodies.is_at_rest(row) && comes_upon(bodies, c, dt))
        bodies.wakefulness[row] = Wakefulness::waking;
    }
  wakefulness_.resize(bodies.size());
  for (std::size_t row = 0; row < bodies.size(); ++row) wakefulness_[row] = double(bodies.wakefulness[row]);
  exchange.share(bodies, wakefulness_, 1);
  for (std::size_t row = bodies.owned; row < bodies.first_wall(); ++row)
    bodies.wakefulness[row] = Wakefulness(int(wakefulness_[row]));
}

void Sleep::find_driven(const BodySet& bodies, const std::vector<Contact>& contacts) {
  driven_.assign(bodies.size(), 0);
  for (const Contact& c : contacts) {
    const std::size_t a = bodies.row_of(c.a), b = bodies.row_of(c.b);
    driven_[a] |= bodies.motion[b] == Motion::prescribed;
    driven_[b] |= bodies.motion[a] == Motion::prescribed;
  }
}

/// (S1)
bool Sleep::is_quiet(const BodySet& bodies, std::size_t row, const StepVelocities& of) const {
  double speed = surface_speed(bodies, row, bodies.twist(row));
  if (!of.push.empty()) speed += surface_speed(bodies, row, of.push[row]);
  return !driven_[row] && speed <= world_.sleep->speed;
}

/// (S2)
bool Sleep::is_balanced(BodySet& bodies, std::size_t row, const StepVelocities& of, double dt) const {
  Rest& rest = bodies.rest[row];
  const double mass = bodies.mass[row], kept = 1 - 1.0 / world_.sleep->steps;
  const Vec3 impulse = (dt * bodies.weight_in_fluid[row] * mass) * world_.gravity +
                       dt * bodies.force[row].value() + Eigen::Map<const Vec3>(rest.impulse) + of.load[row];
  const Vec3 angular_impulse =
      dt * bodies.torque[row].value() + Eigen::Map<const Vec3>(rest.angular_impulse) + of.angular_load[row];
  Eigen::Map<Vec3> v{rest.unbalanced_velocity}, w{rest.unbalanced_angular_velocity};
  v = kept * v + (1 / dt / mass) * impulse;
  w = kept * w + (1 / dt) * angular_velocity_by(bodies, row, angular_impulse);
  return surface_speed(bodies, row, {v, w}) <= hysteresis * world_.sleep->speed;
}

void Sleep::look(BodySet& bodies, const std::vector<Contact>& contacts, const StepVelocities& of, double dt) {
  if (!world_.sleep) return;
  find_driven(bodies, contacts);
  for (std::size_t row = 0; row < bodies.owned; ++row) {
    if (bodies.is_awake(row)) {
      std::int32_t& quiet = bodies.rest[row].quiet_steps;
      quiet = is_quiet(bodies, row, of) ? quiet + 1 : 0;
      if (quiet >= world_.sleep->steps) hold(bodies, row);
    } else if (bodies.wakefulness[row] == Wakefulness::waking ||
               (bodies.is_at_rest(row) && !is_balanced(bodies, row, of, dt))) {
      bodies.wake(row);
    } else if (bodies.wakefulness[row] == Wakefulness::falling_asleep) {
      bodies.wakefulness[row] = Wakefulness::asleep;
    }
  }
}

}  // namespace silt::rigid
