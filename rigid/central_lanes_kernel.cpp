// Contacts on the line of centres. Built once an instruction set.
#include "rigid/lanes_kernel.hpp"

namespace silt::rigid::SILT_ISA {
namespace {

struct CentralChange {
  Vector impulse, torque;  // torque per unit of arm: normal x impulse
  Lanes relative;
};

/// FFD.md 5.2 and 5.3 for eight contacts.
CentralChange solve(CentralGroup& g, const Twist& a, const Twist& b, Mask on) {
  const Vector n = load(g.normal), old_t = load(g.tangential_impulse);
  const Lanes old_n = g.normal_impulse;
  const Vector u = b.v - a.v + cross(b.w * g.arm_b - a.w * g.arm_a, n);
  const Lanes u_n = dot(u, n);
  const Lanes p_n = larger(Lanes{}, old_n + (g.target - u_n) * g.inverse_k_n);
  const Vector p_t = into_cone(old_t - (u - n * u_n) * g.inverse_k_t, g.friction * p_n);
  const Lanes d_n = on ? p_n - old_n : Lanes{};
  const Vector d_t = choose(on, p_t - old_t, Vector{});
  g.normal_impulse = on ? p_n : old_n;
  store(g.tangential_impulse, choose(on, p_t, old_t));
  const Lanes change = d_n * d_n + dot(d_t, d_t);
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
                     const SweepOrder& order) {
  Lanes residual{};
  for (std::size_t k = 0; k < count; ++k) {
    CentralGroup& g = groups[k];
    const Mask on = to_solve(g.bodies, state, order.number == 1);
    const Lanes momentum = momentum_of(g.bodies, g.relative_change, order);
    g.relative_change = Lanes{} - 1;
    if (!any(on)) continue;
    carry_on(g, momentum);
    const CentralChange change = solve(g, Twist(g.bodies.a, state), Twist(g.bodies.b, state), on);
    add_to_bodies(g, change, on, order.tolerance, sums);
    g.relative_change = on ? change.relative : g.relative_change;
    for (int l = 0; l < lane_count; ++l)
      if (g.bodies.again[l] && change.relative[l] > residual[l]) residual[l] = change.relative[l];
  }
  return largest(residual);
}

}  // namespace silt::rigid::SILT_ISA
