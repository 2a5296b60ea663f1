// Central contacts, dry or lubricated (method.md, C4, C5, L1, L2). Built once for each instruction set.
//
// Against an impulse p that would stop a motion of compliance k the film alone gives damped * p. The contact
// adds the rest: normal = larger(damped * stop, stop + target / k), and friction takes its part of the
// tangential impulse before the film. Rolling is eliminated from the tangential motion: one pass is exact.
#include "rigid/response/lanes_kernel.hpp"

namespace silt::rigid::SILT_BUILD {
namespace {

/// Kinds of contact: with a normal impulse only (frictionless), with a tangential one (dry), and with one
/// against rolling (rolling, lubricated).
enum Kind { frictionless, dry, rolling, lubricated };

/// Impulses on b; components that a kind lacks are not computed.
template <Kind kind>
struct Impulse {
  Numbers normal;
  Vector tangential, rolling;
};

/// Applies of(part of p, part of q) to every part.
template <Kind kind, class Of>
[[gnu::always_inline]] inline Impulse<kind> by_part(const Impulse<kind>& p, const Impulse<kind>& q, Of of) {
  Impulse<kind> result;
  result.normal = of(p.normal, q.normal);
  if constexpr (kind >= dry) result.tangential = of(p.tangential, q.tangential);
  if constexpr (kind > dry) result.rolling = of(p.rolling, q.rolling);
  return result;
}
template <Kind kind>
Impulse<kind> operator-(const Impulse<kind>& p, const Impulse<kind>& q) {
  return by_part(p, q, [](const auto& a, const auto& b) { return a - b; });
}
template <Kind kind>
Impulse<kind> choose(const Mask& m, const Impulse<kind>& p, const Impulse<kind>& q) {
  return by_part(p, q, [&](const auto& a, const auto& b) { return choose(m, a, b); });
}
template <Kind kind>
Numbers dot(const Impulse<kind>& p, const Impulse<kind>& q) {
  Numbers sum = p.normal * q.normal;
  if constexpr (kind >= dry) sum += dot(p.tangential, q.tangential);
  if constexpr (kind > dry) sum += dot(p.rolling, q.rolling);
  return sum;
}

/// Reads the current impulses, or those of the last sweep.
template <Kind kind, class Group>
Impulse<kind> impulse_of(const Group& g) {
  Impulse<kind> p;
  p.normal = g.normal_impulse;
  if constexpr (kind >= dry) p.tangential = load(g.tangential_impulse);
  if constexpr (kind > dry) p.rolling = load(g.rolling_impulse);
  return p;
}
template <Kind kind, class Group>
Impulse<kind> last_of(const Group& g) {
  Impulse<kind> p;
  p.normal = g.last_normal;
  if constexpr (kind >= dry) p.tangential = load(g.last_tangential);
  if constexpr (kind > dry) p.rolling = load(g.last_rolling);
  return p;
}
template <Kind kind, class Group>
void store(Group& g, const Impulse<kind>& now, const Impulse<kind>& last) {
  g.normal_impulse = now.normal, g.last_normal = last.normal;
  if constexpr (kind >= dry)
    store(g.tangential_impulse, now.tangential), store(g.last_tangential, last.tangential);
  if constexpr (kind > dry) store(g.rolling_impulse, now.rolling), store(g.last_rolling, last.rolling);
}

/// Solves the pair from its current impulses. Without friction tangential impulses stay zero, as in `dry`.
template <Kind kind>
Impulse<kind> find(const CentralGroup& g, const Impulse<kind>& old, const Twist& a, const Twist& b) {
  const Vector n = load(g.normal), u = b.v - a.v;
  const Numbers u_n = dot(u, n);
  Impulse<kind> p;
  p.normal = larger(Numbers{}, old.normal + (g.target - u_n) * g.inverse_k_n);
  if constexpr (kind == dry) {
    const Vector slip = u + cross(b.w * g.arm_b - a.w * g.arm_a, n) - n * u_n;
    p.tangential = into_cone(old.tangential - slip * g.inverse_k_t, g.friction * p.normal);
  }
  return p;
}

/// While the contact sticks, slip is determined by rolling and eliminated, which is exact. If it slides after
/// all, rolling is solved for with the slip's impulse, and later sweeps continue.
template <Kind kind>
Impulse<kind> find(const RollingGroup& g, const Impulse<kind>& old, const Twist& a, const Twist& b) {
  const Vector n = load(g.normal), u = b.v - a.v;
  const Numbers u_n = dot(u, n);
  Impulse<kind> p;
  p.normal = larger(Numbers{}, old.normal + (g.target - u_n) * g.inverse_k_n);
  const Numbers rub = g.friction * p.normal, brake = g.rolling_friction * p.normal;
  const Vector slip = u + cross(b.w * g.arm_b - a.w * g.arm_a, n) - n * u_n;

  const Vector turn = (b.w - a.w) * g.roll_arm;
  const Numbers twist = dot(turn, n), old_twist = dot(old.rolling, n);
  const Vector roll = turn - n * twist, old_roll = old.rolling - n * old_twist;
  const Vector stuck = into_cone(
      old_roll - (roll - cross(n, slip) * (Numbers(g.roll_to_slip) * g.inverse_k_t)) * g.inverse_k_roll_stuck,
      brake);
  const auto stop_slip = [&](const Vector& rolling) {
    return old.tangential - (slip + cross(rolling - old_roll, n) * g.roll_to_slip) * g.inverse_k_t;
  };
  const Vector held = stop_slip(stuck);
  const Vector rolled =
      choose(dot(held, held) <= rub * rub, stuck, into_cone(old_roll - roll * g.inverse_k_roll, brake));
  p.tangential = into_cone(stop_slip(rolled), rub);
  p.rolling = rolled + into_cone(n * (old_twist - twist * g.inverse_k_roll), g.twisting_friction * p.normal);
  return p;
}

template <Kind kind>
Impulse<kind> find(const LubricatedGroup& g, const Impulse<kind>& old, const Twist& a, const Twist& b) {
  const Vector n = load(g.normal), along = b.v - a.v;
  const Vector u = along + cross(b.w * g.arm_b - a.w * g.arm_a, n);
  const Numbers u_n = dot(u, n);
  const Vector across = along - n * dot(along, n);
  const Vector roll = cross(a.w * g.reach_a - b.w * g.reach_b, n) - across * g.skew;

  const Numbers stop_n = old.normal - (u_n - g.together) * g.inverse_k_n;
  Impulse<kind> p;
  p.normal = larger(g.normal_damped * stop_n, old.normal + (g.target - u_n) * g.inverse_k_n);
  const Numbers pressing = g.normal_stiffness * (p.normal - g.normal_damped * stop_n);

  const Vector unrolled = old.rolling * g.roll_keeps - roll * g.roll_gain;  // for zero impulse against slip
  const Vector slip = u - n * u_n + (unrolled - old.rolling) * g.roll_to_slip;
  const Vector stop_t = old.tangential - slip * g.inverse_k_t;
  const Vector rubbed = into_cone(stop_t, g.friction * pressing);
  p.tangential = rubbed + (stop_t - rubbed) * g.tangential_damped;
  p.rolling = unrolled - (p.tangential - old.tangential) * (Numbers(g.roll_to_slip) * g.roll_gain);
  return p;
}

/// Returns the effect on the bodies of a change of the impulses.
template <Kind kind>
Push push_by(const CentralGroup& g, const Impulse<kind>& d) {
  const Vector n = load(g.normal);
  if constexpr (kind == frictionless) return {n * d.normal, {}, {}};
  const Vector torque = cross(n, d.tangential);  // per unit arm
  return {n * d.normal + d.tangential, torque * (Numbers{} - g.arm_a), torque * g.arm_b};
}
template <Kind kind>
Push push_by(const RollingGroup& g, const Impulse<kind>& d) {
  const Vector n = load(g.normal), slip = cross(n, d.tangential), roll = d.rolling * g.roll_arm;
  return {n * d.normal + d.tangential, slip * (Numbers{} - g.arm_a) - roll, slip * g.arm_b + roll};
}
template <Kind kind>
Push push_by(const LubricatedGroup& g, const Impulse<kind>& d) {
  const Vector n = load(g.normal), slip = cross(n, d.tangential), roll = cross(n, d.rolling);
  return {n * d.normal + d.tangential - d.rolling * g.skew, roll * g.reach_a - slip * g.arm_a,
          slip * g.arm_b - roll * g.reach_b};
}

/// Solves the pairs of a group once and extrapolates along their last change (method-bodies.md, a sweep).
/// Returns the squares of the relative changes.
template <Kind kind, class Group>
Numbers sweep_group(Group& g, const LanesToSolve& lanes, const BodyState* state, BodySum* sums,
                    double tolerance) {
  const auto moving = [&](const std::int32_t* rows) {
    if constexpr (kind >= dry) return twists(rows, state);
    return Twist{velocities(rows, state), {}};
  };
  const Mask on = lanes.on;
  const auto old = impulse_of<kind>(g), last = last_of<kind>(g),
             found = find<kind>(g, old, moving(g.bodies.a), moving(g.bodies.b)), on_by = found - last,
             step = found - old;
  const Numbers beta = momentum(g.age, dot(old - found, on_by), lanes.to_carry);
  g.carried = choose(on, beta, g.carried);
  const auto p = by_part(found, on_by, [&](const auto& f, const auto& by) { return f + by * beta; });
  const auto d = choose(on, p - old, Impulse<kind>{});
  store<kind>(g, choose(on, p, old), choose(on, found, last));
  const Numbers change = larger(dot(d, d), dot(step, step));
  const Numbers scale = larger(larger(dot(old, old), dot(p, p)), Numbers(g.least_scale) * g.least_scale);
  const Numbers relative = choose(change > 0, change / scale, Numbers{});
  add_to_bodies<(kind >= dry)>(g.bodies, push_by(g, d), on, relative > tolerance * tolerance, sums);
  return relative;
}

/// Sweeps all groups that have a pair to solve.
template <class Group, class SweepGroup>
SweepOutcome sweep_all(std::span<Group> groups, const BodyState* state, const ContactSweep& sweep,
                       SweepGroup sweep_one) {
  Outcome outcome;
  for (Group& g : groups) {
    const LanesToSolve lanes = to_solve(g.bodies, g.carried, state, sweep);
    if (any_lane(lanes.on)) outcome.add(g, sweep_one(g, lanes));
  }
  return outcome.of_squares();
}

}  // namespace

SweepOutcome sweep_central(std::span<CentralGroup> groups, const BodyState* state, BodySum* sums,
                           const ContactSweep& sweep) {
  return sweep_all(groups, state, sweep, [&](CentralGroup& g, const LanesToSolve& lanes) {
    return any_lane(Numbers(g.friction) > 0)
               ? sweep_group<dry>(g, lanes, state, sums, sweep.tolerance)
               : sweep_group<frictionless>(g, lanes, state, sums, sweep.tolerance);
  });
}

SweepOutcome sweep_rolling(std::span<RollingGroup> groups, const BodyState* state, BodySum* sums,
                           const ContactSweep& sweep) {
  return sweep_all(groups, state, sweep, [&](RollingGroup& g, const LanesToSolve& lanes) {
    return sweep_group<rolling>(g, lanes, state, sums, sweep.tolerance);
  });
}

SweepOutcome sweep_lubricated(std::span<LubricatedGroup> groups, const BodyState* state, BodySum* sums,
                              const ContactSweep& sweep) {
  return sweep_all(groups, state, sweep, [&](LubricatedGroup& g, const LanesToSolve& lanes) {
    return sweep_group<lubricated>(g, lanes, state, sums, sweep.tolerance);
  });
}

}  // namespace silt::rigid::SILT_BUILD
