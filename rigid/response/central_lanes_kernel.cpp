// Contacts on the line of centres. Built once an instruction set.
#include "rigid/response/lanes_kernel.hpp"

namespace silt::rigid::SILT_ISA {
namespace {

struct CentralChange {
  Vector impulse, torque;  // torque per unit of arm: normal x impulse
  Numbers relative;        // squared
};

/// (C4) and (C5) of rigid/README.md for eight contacts, carried on along their last change. `rubs` false:
/// none of the eight has friction; their tangential impulses are zero and stay so, and the bits are those of
/// `rubs`.
template <bool rubs>
CentralChange solve(CentralGroup& g, const Twist& a, const Twist& b, const LanesToSolve& lanes) {
  const Mask on = lanes.on;
  const Vector n = load(g.normal), u = b.v - a.v;
  const Numbers old_n = g.normal_impulse, last_n = g.last_normal, u_n = dot(u, n);
  const Numbers found_n = larger(Numbers{}, old_n + (g.target - u_n) * g.inverse_k_n);
  const Numbers on_n = found_n - last_n;
  Numbers led_wrong = (old_n - found_n) * on_n;
  Vector old_t, last_t, found_t, on_t;
  if constexpr (rubs) {
    old_t = load(g.tangential_impulse);
    last_t = load(g.last_tangential);
    const Vector slip = u + cross(b.w * g.arm_b - a.w * g.arm_a, n) - n * u_n;
    found_t = into_cone(old_t - slip * g.inverse_k_t, g.friction * found_n);
    on_t = found_t - last_t;
    led_wrong += dot(old_t - found_t, on_t);
  }
  const Numbers beta = momentum(g.age, led_wrong, lanes.to_carry);
  g.carried = choose(on, beta, g.carried);
  const Numbers p_n = found_n + beta * on_n, d_n = choose(on, p_n - old_n, Numbers{}),
                step_n = found_n - old_n;
  g.normal_impulse = choose(on, p_n, old_n);
  g.last_normal = choose(on, found_n, last_n);
  Numbers moved = d_n * d_n, stepped = step_n * step_n, before = old_n * old_n, after = p_n * p_n;
  CentralChange change{n * d_n, {}, {}};
  if constexpr (rubs) {
    const Vector p_t = found_t + on_t * beta, step_t = found_t - old_t;
    const Vector d_t = choose(on, p_t - old_t, Vector{});
    store(g.tangential_impulse, choose(on, p_t, old_t));
    store(g.last_tangential, choose(on, found_t, last_t));
    moved += dot(d_t, d_t);
    stepped += dot(step_t, step_t);
    before += dot(old_t, old_t);
    after += dot(p_t, p_t);
    change.impulse += d_t;
    change.torque = cross(n, d_t);
  }
  const Numbers most = larger(moved, stepped);
  const Numbers scale = larger(larger(before, after), Numbers(g.least_scale) * g.least_scale);
  change.relative = choose(most > 0, most / scale, Numbers{});
  return change;
}

template <bool rubs>
Numbers sweep_group(CentralGroup& g, const LanesToSolve& lanes, const BodyState* state, BodySum* sums,
                    const ContactSweep& sweep) {
  const auto moving = [&](const std::int32_t* rows) {
    if constexpr (rubs) return twists(rows, state);
    return Twist{velocities(rows, state), {}};
  };
  const CentralChange change = solve<rubs>(g, moving(g.bodies.a), moving(g.bodies.b), lanes);
  const Vector& torque = change.torque;
  Vector on_a, on_b;
  if constexpr (rubs) on_a = torque * (Numbers{} - g.arm_a), on_b = torque * g.arm_b;
  add_to_bodies<rubs>(g.bodies, {change.impulse, on_a, on_b}, lanes.on,
                      change.relative > sweep.tolerance * sweep.tolerance, sums);
  return change.relative;
}

}  // namespace

SweepOutcome sweep_central(CentralGroup* groups, std::size_t count, const BodyState* state, BodySum* sums,
                           const ContactSweep& sweep) {
  Outcome outcome;
  for (std::size_t k = 0; k < count; ++k) {
    CentralGroup& g = groups[k];
    const LanesToSolve lanes = to_solve(g.bodies, g.carried, state, sweep);
    if (!any_lane(lanes.on)) continue;
    outcome.add(g, any_lane(Numbers(g.friction) > 0) ? sweep_group<true>(g, lanes, state, sums, sweep)
                                                     : sweep_group<false>(g, lanes, state, sums, sweep));
  }
  return outcome.of_squares();
}

}  // namespace silt::rigid::SILT_ISA
