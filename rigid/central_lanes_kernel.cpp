// Contacts on the line of centres. Built once an instruction set.
#include "rigid/lanes_kernel.hpp"

namespace silt::rigid::SILT_ISA {
namespace {

struct CentralChange {
  Vector impulse, torque;  // torque per unit of arm: normal x impulse
  Lanes relative;
};

/// FFD.md 5.2 and 5.3 for eight contacts, and 5.4's acceleration.
CentralChange solve(CentralGroup& g, const Twist& a, const Twist& b, Mask on, bool plain) {
  const Vector n = load(g.normal), old_t = load(g.tangential_impulse), last_t = load(g.last_tangential);
  const Lanes old_n = g.normal_impulse, last_n = g.last_normal;
  const Vector u = b.v - a.v + cross(b.w * g.arm_b - a.w * g.arm_a, n);
  const Lanes u_n = dot(u, n);
  const Lanes found_n = larger(Lanes{}, old_n + (g.target - u_n) * g.inverse_k_n);
  const Vector found_t = into_cone(old_t - (u - n * u_n) * g.inverse_k_t, g.friction * found_n);
  const Lanes on_n = found_n - last_n;
  const Vector on_t = found_t - last_t;
  const Lanes beta =
      plain ? Lanes{}
            : momentum(g.age, (old_n - found_n) * on_n + dot(old_t - found_t, on_t), on & goes_on(g.bodies));
  g.carried = on ? beta : g.carried;
  const Lanes p_n = found_n + beta * on_n;
  const Vector p_t = found_t + on_t * beta;
  const Lanes d_n = on ? p_n - old_n : Lanes{};
  const Vector d_t = choose(on, p_t - old_t, Vector{});
  g.normal_impulse = on ? p_n : old_n;
  store(g.tangential_impulse, choose(on, p_t, old_t));
  g.last_normal = on ? found_n : last_n;
  store(g.last_tangential, choose(on, found_t, last_t));
  const Lanes step_n = found_n - old_n;
  const Vector step_t = found_t - old_t;
  const Lanes change = larger(d_n * d_n + dot(d_t, d_t), step_n * step_n + dot(step_t, step_t));
  const Lanes scale = larger(larger(old_n * old_n + dot(old_t, old_t), p_n * p_n + dot(p_t, p_t)),
                             g.least_scale * g.least_scale);
  return {n * d_n + d_t, cross(n, d_t), change > 0 ? square_root(change / scale) : Lanes{}};
}

void add_to_bodies(const CentralGroup& g, const CentralChange& change, Mask on, double tolerance,
                   BodySum* sums) {
  const Vector &p = change.impulse, t_a = change.torque * g.arm_a, t_b = change.torque * g.arm_b;
  for (int l = 0; l < lane_count; ++l) {
    if (!on[l]) continue;
    BodySum &a = sums[g.bodies.a[l]], &b = sums[g.bodies.b[l]];
    a.impulse[0] -= p.x[l], a.impulse[1] -= p.y[l], a.impulse[2] -= p.z[l];
    a.angular[0] -= t_a.x[l], a.angular[1] -= t_a.y[l], a.angular[2] -= t_a.z[l];
    b.impulse[0] += p.x[l], b.impulse[1] += p.y[l], b.impulse[2] += p.z[l];
    b.angular[0] += t_b.x[l], b.angular[1] += t_b.y[l], b.angular[2] += t_b.z[l];
    if (change.relative[l] > tolerance) a.changed = b.changed = 1;
  }
}

}  // namespace

double sweep_central(CentralGroup* groups, std::size_t count, const BodyState* state, BodySum* sums,
                     const Sweep& sweep) {
  Lanes residual{};
  for (std::size_t k = 0; k < count; ++k) {
    CentralGroup& g = groups[k];
    const Mask on = to_solve(g.bodies, g.carried, state, sweep);
    if (!any(on)) continue;
    const CentralChange change =
        solve(g, Twist(g.bodies.a, state), Twist(g.bodies.b, state), on, sweep.plain);
    add_to_bodies(g, change, on, sweep.tolerance, sums);
    residual = goes_on(g.bodies) & (change.relative > residual) ? change.relative : residual;
  }
  return largest(residual);
}

}  // namespace silt::rigid::SILT_ISA
