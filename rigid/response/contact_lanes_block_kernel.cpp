// Pairs with any number of contacts: first a trial in which all contacts stick, then Gauss-Seidel over the
// contacts of a pair. Built once for each instruction set.
#include "rigid/response/stick_trial_kernel.hpp"

namespace silt::rigid::SILT_BUILD {
namespace {

constexpr int most_rounds = 100;         // of Gauss-Seidel within a pair that is solved once
constexpr double converged = 1e-14;      // relative change of an impulse in a round
constexpr double converged_push = 1e-6;  // the same in the position correction

/// Gauss-Seidel rounds of eight pairs.
struct Rounds {
  PairMotion motion;
  Mask active;
  Numbers change{}, scale{};                      // largest squares in the round
  Numbers moved{};                                // bound on the change of a contact's impulse in all rounds
  Mask cut_short{};                               // lanes that reached the limit of rounds
  const BlockLubrication* lubrication = nullptr;  // of the group's contacts, or null
  BlockRolling* rolling = nullptr;                // of the group's contacts, or null

  /// Return new impulses from those that would stop the contact: (C4), (C5) of method.md, (L2) for a film.
  static Numbers normal(const BlockContact& c, const BlockLubrication* lubrication, Numbers stop,
                        Numbers u_n) {
    const Numbers hard = c.normal_impulse + (c.target - u_n) * c.inverse_k_n;
    if (!lubrication) return larger(Numbers(), hard);
    const Numbers held = lubrication->normal_held;
    return choose(held > 0, Numbers() - held * u_n, larger(lubrication->normal_damped * stop, hard));
  }
  static Vector tangential(const BlockContact& c, const BlockLubrication* lubrication, const Vector& stop,
                           const Vector& slip, Numbers stop_n, Numbers p_n) {
    if (!lubrication) return into_cone(stop, c.friction * p_n);
    const Numbers pressing = lubrication->normal_stiffness * (p_n - lubrication->normal_damped * stop_n);
    const Vector rubbed = into_cone(stop, c.friction * pressing);
    const Numbers held = lubrication->tangential_held;
    return choose(held > 0, slip * (Numbers() - held),
                  rubbed + (stop - rubbed) * lubrication->tangential_damped);
  }

  /// Solves (C4) for the normal impulse, then (C5) for the tangential one.
  void solve(const BlockGroup& g, BlockContact& c, const BlockLubrication* lubrication) {
    const Vector r = load(c.r), n = load(c.normal), u = motion.at(r), old_t = load(c.tangential_impulse);
    const Numbers old_n = c.normal_impulse;
    const Numbers u_n = dot(u, n), stop_n = old_n - u_n * c.inverse_k_n,
                  p_n = normal(c, lubrication, stop_n, u_n);
    const Numbers d_n = choose(active, p_n - old_n, Numbers{});
    const Vector s = u + load(c.k_normal) * d_n, slip = s - n * dot(s, n),
                 stop_t = old_t - slip * c.inverse_k_t;
    const Vector p_t = tangential(c, lubrication, stop_t, slip, stop_n, p_n);
    const Vector d_t = choose(active, p_t - old_t, Vector{});
    c.normal_impulse = choose(active, p_n, old_n);
    store(c.tangential_impulse, choose(active, p_t, old_t));
    change = larger(change, d_n * d_n + dot(d_t, d_t));
    scale = choose(active, larger(scale, p_n * p_n + dot(p_t, p_t)), scale);
    motion.push(g, r, n * d_n + d_t);
  }

  /// Then solves for the moments against rolling and twisting.
  void resist(const BlockGroup& g, const BlockContact& c, BlockRolling& r) {
    const Vector n = load(c.normal), old = load(r.impulse);
    const Vector stop = old - motion.omega * (Numbers(r.roll_arm) * r.inverse_k_roll);
    const Numbers twist = dot(stop, n), pressing = larger(Numbers{}, Numbers(c.normal_impulse));
    const Vector p = into_cone(stop - n * twist, r.rolling_friction * pressing) +
                     into_cone(n * twist, r.twisting_friction * pressing);
    const Vector d = choose(active, p - old, Vector{});
    store(r.impulse, old + d);
    change = larger(change, dot(d, d));
    scale = choose(active, larger(scale, dot(p, p)), scale);
    motion.push_about_a(g, {}, d * r.roll_arm);
  }

  /// Returns the square of the pair's total impulse in this sweep.
  Numbers total(const BlockGroup& g) const {
    return dot(motion.impulse, motion.impulse) +
           Numbers(g.inverse_arm) * g.inverse_arm * dot(motion.angular, motion.angular);
  }

  /// Runs the rounds. A lane that has converged keeps its result. Pairs that later sweeps solve again get one
  /// round: in beds, more rounds did not reduce overlaps.
  void run(const BlockGroup& g, BlockContact* contacts, double tolerance) {
    const Mask final = ~needs_sweeps(g.bodies);
    for (int round = 0; round < most_rounds && any_lane(active); ++round) {
      change = Numbers{};
      scale = choose(active, Numbers{}, scale);
      for (std::uint32_t c = 0; c < g.count; ++c) {
        solve(g, contacts[c], lubrication ? lubrication + c : nullptr);
        if (rolling) resist(g, contacts[c], rolling[c]);
      }
      moved += square_root(change);
      active = active & (change > tolerance * tolerance * scale);
      if (rolling) continue;  // rolling and slip are coupled too closely for one round
      cut_short = cut_short | (active & ~final);
      active = active & final;
    }
    cut_short = cut_short | active;
  }
};

/// Extrapolates the impulses along their last change.
class CarryOn {
 public:
  CarryOn(const BlockGroup& g, const BlockContact* contacts) : used_(g.count <= most) {
    for (std::uint32_t k = 0; used_ && k < g.count; ++k) {
      old_n_[k] = contacts[k].normal_impulse;
      old_t_[k] = load(contacts[k].tangential_impulse);
    }
  }
  void operator()(BlockGroup& g, BlockContact* contacts, PairMotion& motion,
                  const LanesToSolve& lanes) const {
    if (!used_) return;
    Numbers opposed{};
    for (std::uint32_t k = 0; k < g.count; ++k) {
      const BlockContact& c = contacts[k];
      const Vector found_t = load(c.tangential_impulse);
      opposed += (old_n_[k] - c.normal_impulse) * (Numbers(c.normal_impulse) - c.last_normal) +
                 dot(old_t_[k] - found_t, found_t - load(c.last_tangential));
    }
    const Mask on = lanes.on;
    const Numbers beta = momentum(g.age, opposed, lanes.to_carry);
    g.carried = choose(on, beta, g.carried);
    Vector impulse{}, moment{};
    for (std::uint32_t k = 0; k < g.count; ++k) {
      BlockContact& c = contacts[k];
      const Vector found_t = load(c.tangential_impulse), last_t = load(c.last_tangential);
      const Numbers found_n = c.normal_impulse, on_n = beta * (found_n - c.last_normal);
      const Vector on_t = (found_t - last_t) * beta;
      c.last_normal = choose(on, found_n, c.last_normal);
      store(c.last_tangential, choose(on, found_t, last_t));
      c.normal_impulse = found_n + on_n;
      store(c.tangential_impulse, found_t + on_t);
      const Vector p = load(c.normal) * on_n + on_t;
      impulse += p;
      moment += cross(load(c.r), p);
    }
    motion.push_about_a(g, impulse, moment);
  }

 private:
  static constexpr std::uint32_t most = 16;  // contacts of a pair; with more there is no extrapolation
  bool used_;
  Numbers old_n_[most];
  Vector old_t_[most];
};

/// Stores the result. A pair whose rounds were cut short is not final, however small its change.
void finish(BlockGroup& g, const Rounds& rounds, Mask solved, double tolerance) {
  store(g.impulse, rounds.motion.impulse);
  store(g.angular, rounds.motion.angular);
  const Numbers change = larger(rounds.total(g), rounds.moved * rounds.moved);
  const Numbers scale = larger(rounds.scale, Numbers(g.least_scale) * g.least_scale);
  const Numbers moved = choose(change > 0, square_root(change / scale), Numbers{});
  for (int l = 0; l < lane_count; ++l) g.bodies.again[l] |= rounds.cut_short[l] != 0;
  const Numbers relative = choose(rounds.cut_short, larger(moved, Numbers{} + 2 * tolerance), moved);
  g.relative_change = choose(solved, relative, -1);
}

}  // namespace

void prepare_blocks(std::span<BlockGroup> groups) {
  for (BlockGroup& g : groups) set_inverse_mobility(g);
}

SweepOutcome sweep_blocks(std::span<BlockGroup> groups, BlockContact* all_contacts,
                          const BlockLubrication* all_lubrication, BlockRolling* all_rolling,
                          const BodyState* state, const ContactSweep& sweep) {
  Outcome outcome;
  for (BlockGroup& g : groups) {
    BlockContact* contacts = all_contacts + g.first;
    const LanesToSolve lanes = to_solve(g.bodies, g.carried, state, sweep);
    g.relative_change = Numbers{} - 1;
    if (!any_lane(lanes.on)) continue;
    const CarryOn carry_on(g, contacts);
    Rounds rounds{PairMotion(g, twists(g.bodies.a, state), twists(g.bodies.b, state)), lanes.on};
    if (g.first_rolling != without && !sweep.push) rounds.rolling = all_rolling + g.first_rolling;
    rounds.lubrication =
        g.first_lubrication != without && !sweep.push ? all_lubrication + g.first_lubrication : nullptr;
    if (rounds.lubrication || rounds.rolling)
      ;  // lubricated surfaces creep, and moments share the load: the contacts cannot all stick
    else if (sweep.push)
      try_sticking<true>(g, contacts, rounds.motion, rounds.active, rounds.scale);
    else
      try_sticking<false>(g, contacts, rounds.motion, rounds.active, rounds.scale);
    rounds.run(g, contacts, sweep.push ? converged_push : converged);
    g.carried = choose(lanes.on, Numbers{}, g.carried);
    if (!sweep.plain) carry_on(g, contacts, rounds.motion, lanes);
    finish(g, rounds, lanes.on, sweep.tolerance);
    outcome.add(g, g.relative_change);
  }
  return outcome.all();
}

}  // namespace silt::rigid::SILT_BUILD
