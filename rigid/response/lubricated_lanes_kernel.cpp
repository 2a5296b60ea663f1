// Contacts on the line of centres with a lubrication film in the gap (rigid/README.md, L1 and L2). Built once
// an instruction set.
//
// An impulse p that would stop a motion of compliance k becomes damped * p by the film alone. The contact
// adds what is missing: normal = larger(damped * stop, stop + target / k), and friction takes its part of the
// tangential one before the film does. Rolling is eliminated from the tangential motion, so that one pass is
// exact here too.
#include "rigid/response/lanes_kernel.hpp"

namespace silt::rigid::SILT_ISA {
namespace {

/// Impulses on b: at the contact, and against rolling.
struct LubricatedImpulse {
  Numbers normal;
  Vector tangential, rolling;

  LubricatedImpulse operator-(const LubricatedImpulse& o) const {
    return {normal - o.normal, tangential - o.tangential, rolling - o.rolling};
  }
  LubricatedImpulse operator+(const LubricatedImpulse& o) const {
    return {normal + o.normal, tangential + o.tangential, rolling + o.rolling};
  }
  LubricatedImpulse operator*(Numbers s) const { return {normal * s, tangential * s, rolling * s}; }
};

Numbers dot(const LubricatedImpulse& p, const LubricatedImpulse& q) {
  return p.normal * q.normal + dot(p.tangential, q.tangential) + dot(p.rolling, q.rolling);
}
LubricatedImpulse choose(Mask m, const LubricatedImpulse& p, const LubricatedImpulse& q) {
  return {choose(m, p.normal, q.normal), choose(m, p.tangential, q.tangential),
          choose(m, p.rolling, q.rolling)};
}
LubricatedImpulse impulse_of(const LubricatedGroup& g) {
  return {g.normal_impulse, load(g.tangential_impulse), load(g.rolling_impulse)};
}
LubricatedImpulse last_of(const LubricatedGroup& g) {
  return {g.last_normal, load(g.last_tangential), load(g.last_rolling)};
}

/// The pair alone, from the impulses at hand.
LubricatedImpulse find(const LubricatedGroup& g, const LubricatedImpulse& old, const Twist& a,
                       const Twist& b) {
  const Vector n = load(g.normal), along = b.v - a.v;
  const Vector u = along + cross(b.w * g.arm_b - a.w * g.arm_a, n);
  const Numbers u_n = dot(u, n);
  const Vector across = along - n * dot(along, n);
  const Vector roll = cross(a.w * g.reach_a - b.w * g.reach_b, n) - across * g.skew;

  const Numbers stop_n = old.normal - u_n * g.inverse_k_n;
  LubricatedImpulse p;
  p.normal = larger(g.normal_damped * stop_n, old.normal + (g.target - u_n) * g.inverse_k_n);
  const Numbers pressing = g.normal_stiffness * (p.normal - g.normal_damped * stop_n);

  const Vector unrolled = old.rolling * g.roll_keeps - roll * g.roll_gain;  // if slip took no impulse
  const Vector slip = u - n * u_n + (unrolled - old.rolling) * g.roll_to_slip;
  const Vector stop_t = old.tangential - slip * g.inverse_k_t;
  const Vector rubbed = into_cone(stop_t, g.friction * pressing);
  p.tangential = rubbed + (stop_t - rubbed) * g.tangential_damped;
  p.rolling = unrolled - (p.tangential - old.tangential) * (Numbers(g.roll_to_slip) * g.roll_gain);
  return p;
}

struct LubricatedChange {
  LubricatedImpulse impulse;
  Numbers relative;  // squared
};

/// The pair, carried on along its last change (rigid/README.md, a sweep).
LubricatedChange solve(LubricatedGroup& g, const Twist& a, const Twist& b, const LanesToSolve& lanes) {
  const Mask on = lanes.on;
  const LubricatedImpulse old = impulse_of(g), last = last_of(g), found = find(g, old, a, b),
                          on_by = found - last;
  const Numbers beta = momentum(g.age, dot(old - found, on_by), lanes.to_carry);
  g.carried = choose(on, beta, g.carried);
  const LubricatedImpulse p = found + on_by * beta, d = choose(on, p - old, LubricatedImpulse{}),
                          step = found - old;
  const LubricatedImpulse now = choose(on, p, old), then = choose(on, found, last);
  g.normal_impulse = now.normal;
  g.last_normal = then.normal;
  store(g.tangential_impulse, now.tangential);
  store(g.last_tangential, then.tangential);
  store(g.rolling_impulse, now.rolling);
  store(g.last_rolling, then.rolling);
  const Numbers change = larger(dot(d, d), dot(step, step));
  const Numbers scale = larger(larger(dot(old, old), dot(p, p)), Numbers(g.least_scale) * g.least_scale);
  return {d, choose(change > 0, change / scale, Numbers{})};
}

void add_change(const LubricatedGroup& g, const LubricatedChange& change, Mask on, double tolerance,
                BodySum* sums) {
  const LubricatedImpulse& d = change.impulse;
  const Vector n = load(g.normal), p = n * d.normal + d.tangential - d.rolling * g.skew;
  const Vector slip = cross(n, d.tangential), roll = cross(n, d.rolling);
  const Vector on_a = roll * g.reach_a - slip * g.arm_a, on_b = slip * g.arm_b - roll * g.reach_b;
  add_to_bodies<true>(g.bodies, {p, on_a, on_b}, on, change.relative > tolerance * tolerance, sums);
}

}  // namespace

SweepOutcome sweep_lubricated(LubricatedGroup* groups, std::size_t count, const BodyState* state,
                              BodySum* sums, const ContactSweep& sweep) {
  Outcome outcome;
  for (std::size_t k = 0; k < count; ++k) {
    LubricatedGroup& g = groups[k];
    const LanesToSolve lanes = to_solve(g.bodies, g.carried, state, sweep);
    if (!any_lane(lanes.on)) continue;
    const LubricatedChange change = solve(g, twists(g.bodies.a, state), twists(g.bodies.b, state), lanes);
    add_change(g, change, lanes.on, sweep.tolerance, sums);
    outcome.add(g, change.relative);
  }
  return outcome.of_squares();
}

}  // namespace silt::rigid::SILT_ISA
