// Pairs with any contacts: first the guess that all of them stick, then Gauss-Seidel over the contacts of a
// pair. Built once an instruction set.
#include "rigid/stick_trial_kernel.hpp"

namespace silt::rigid::SILT_ISA {
namespace {

constexpr int most_rounds = 100;         // of Gauss-Seidel within a pair that is solved once
constexpr int few_rounds = 8;            // ... that later sweeps and steps go on with
constexpr int few_sweeps = 16;           // with so few rounds: who asks for more sweeps wants the law
constexpr double converged = 1e-14;      // change of an impulse in a round, relative to the largest
constexpr double converged_push = 1e-6;  // the same where only positions are corrected
constexpr double worth_another = 0;      // ... relative to what the pair changes in this sweep

/// The rounds of eight pairs.
struct Rounds {
  PairMotion motion;
  Mask active;
  Lanes change{}, scale{};  // squared, largest of the round
  Lanes moved{};            // at most: a contact's impulse, in all rounds

  /// FFD.md 5.3: first the normal impulse, then the tangential one.
  void solve(const BlockGroup& g, BlockContact& c) {
    const Vector r = load(c.r), n = load(c.normal), u = motion.at(r), old_t = load(c.tangential_impulse);
    const Lanes old_n = c.normal_impulse;
    const Lanes p_n = larger(Lanes{}, old_n + (c.target - dot(u, n)) * c.inverse_k_n);
    const Lanes d_n = active ? p_n - old_n : Lanes{};
    const Vector s = u + load(c.k_normal) * d_n;
    const Vector p_t = into_cone(old_t - (s - n * dot(s, n)) * c.inverse_k_t, c.friction * p_n);
    const Vector d_t = choose(active, p_t - old_t, Vector{});
    c.normal_impulse = active ? p_n : old_n;
    store(c.tangential_impulse, choose(active, p_t, old_t));
    change = larger(change, d_n * d_n + dot(d_t, d_t));
    scale = active ? larger(scale, p_n * p_n + dot(p_t, p_t)) : scale;
    motion.push(g, r, n * d_n + d_t);
  }

  /// Squared, of the whole pair in this sweep.
  Lanes total(const BlockGroup& g) const {
    return dot(motion.impulse, motion.impulse) +
           g.inverse_arm * g.inverse_arm * dot(motion.angular, motion.angular);
  }

  /// A lane that has settled ends, and keeps its result whatever the others do.
  void run(const BlockGroup& g, BlockContact* contacts, double tolerance, int rounds) {
    Mask final;
    for (int l = 0; l < lane_count; ++l) final[l] = g.bodies.again[l] ? 0 : -1;
    for (int round = 0; round < most_rounds && any(active); ++round) {
      change = Lanes{};
      scale = active ? Lanes{} : scale;
      for (std::uint32_t c = 0; c < g.count; ++c) solve(g, contacts[c]);
      moved += square_root(change);
      const Lanes enough = larger(tolerance * tolerance * scale, worth_another * worth_another * total(g));
      active = active & (change > enough);
      if (round + 1 >= rounds) active = active & final;
    }
  }
};

void finish(BlockGroup& g, const Rounds& rounds, Mask solved) {
  store(g.impulse, rounds.motion.impulse);
  store(g.angular, rounds.motion.angular);
  const Lanes change = larger(rounds.total(g), rounds.moved * rounds.moved);
  const Lanes scale = larger(rounds.scale, g.least_scale * g.least_scale);
  const Lanes relative = change > 0 ? square_root(change / scale) : Lanes{};
  g.relative_change = solved ? relative : Lanes{} - 1;
}

}  // namespace

void prepare_blocks(BlockGroup* groups, std::size_t count) {
  for (std::size_t k = 0; k < count; ++k) set_inverse_mobility(groups[k]);
}

double sweep_blocks(BlockGroup* groups, std::size_t count, BlockContact* all_contacts, const BodyState* state,
                    const SweepOrder& order) {
  double residual = 0;
  for (std::size_t k = 0; k < count; ++k) {
    BlockGroup& g = groups[k];
    BlockContact* contacts = all_contacts + g.first;
    const Mask solved = to_solve(g.bodies, state, order.number == 1);
    const Lanes momentum = momentum_of(g.bodies, g.relative_change, order);
    g.relative_change = Lanes{} - 1;
    if (!any(solved)) continue;
    for (std::uint32_t c = 0; c < g.count; ++c) carry_on(contacts[c], momentum);
    Rounds rounds{PairMotion(g, Twist(g.bodies.a, state), Twist(g.bodies.b, state)), solved};
    if (order.push)
      try_sticking<true>(g, contacts, rounds.motion, rounds.active, rounds.scale);
    else
      try_sticking<false>(g, contacts, rounds.motion, rounds.active, rounds.scale);
    rounds.run(g, contacts, order.push ? converged_push : converged,
               order.number <= few_sweeps ? few_rounds : most_rounds);
    finish(g, rounds, solved);
    for (int l = 0; l < lane_count; ++l)
      if (g.bodies.again[l] && g.relative_change[l] > residual) residual = g.relative_change[l];
  }
  return residual;
}

}  // namespace silt::rigid::SILT_ISA
