#include "rigid/response/sffd_resolver.hpp"

#include <algorithm>
#include <cmath>

#include "cpu/prefetch.hpp"
#include "rigid/bodies/body_exchange.hpp"
#include "rigid/response/contact_targets.hpp"

namespace silt::rigid {
namespace {

constexpr int state_width = sizeof(BodyState) / sizeof(double);  // doubles per body in a share
/// Relative to mass x speed: smaller impulses are ignored by the test of convergence.
constexpr double impulse_rounding = 1e-5;
constexpr int accelerated_sweeps = 64;    // pairs that have not converged by then do better without
constexpr int most_start_sweeps = 10000;  // for chains at the start: a mass ratio of 10^4 takes 9000
constexpr double push_tolerance = 1e-3;   // relative change of the position correction's impulses
constexpr double push_rounding = 1e-7;    // displacement per step, relative to the contact's lever arms
constexpr int pairs_ahead = 8;            // distance of prefetching

Twist twist_of(const BodyState& s) {
  return {{s.v[0], s.v[1], s.v[2]}, {s.w[0], s.w[1], s.w[2]}};
}

void store(BodyState& s, const Twist& t, double number) {
  Eigen::Map<Vec3>{s.v} = t.v;
  Eigen::Map<Vec3>{s.w} = t.w;
  s.number = number;
  s.unused = 0;
}

std::span<double> as_doubles(std::vector<BodyState>& state) {
  return {&state.data()->v[0], (state.size() - 1) * state_width};  // without the row at rest
}

/// Prefetches the first cache lines of a body's list, which may be anywhere in memory.
void prefetch_impulses(const std::vector<StoredImpulse>& stored) {
  constexpr std::size_t line = 64, lines = 3;
  const char* const first = reinterpret_cast<const char*>(stored.data());
  for (std::size_t k = 0; k < lines; ++k) prefetch_to_read(first + line * k);
}

void add(BodySum& sum, const Vec3& r, const Vec3& impulse) {
  const Vec3 angular = r.cross(impulse);
  for (int d = 0; d < 3; ++d) {
    sum.impulse[d] += impulse[d];
    sum.angular[d] += angular[d];
  }
}

}  // namespace

void SffdResolver::involve(const BodySet& bodies, std::size_t row) {
  Body& b = bodies_[row];
  if (b.involved) return;
  b.involved = true;
  b.pairs = 0;
  involved_.push_back(row);
  const bool free = bodies.is_dynamic(row);
  b.moves = row < bodies.owned && free;
  b.inverse_mass = bodies.inverse_mass(row);
  b.inverse_inertia = bodies.inverse_inertia_W(row);
  b.locked = free ? bodies.locked(row) : LockedAxes{0};
  if (b.locked) locked_.push_back(row);
  b.isotropic = !free || bodies.is_isotropic(row);
  b.turns = free || bodies.angular_velocity[row] != Vec3::Zero();
  b.size = std::sqrt(bodies.inertia_B[row].trace() / (3 * bodies.mass[row]));
}

/// Returns the number of contacts whose body of lower id is owned.
std::size_t SffdResolver::collect_pairs(const BodySet& bodies, const std::vector<Contact>& contacts) {
  std::size_t owned_contacts = 0;
  pairs_.clear();
  for (const std::size_t row : involved_) bodies_[row].involved = false;
  bodies_.resize(bodies.size() + 1);
  involved_.clear();
  locked_.clear();
  std::size_t row_a = 0;
  for_each_pair(contacts, [&](std::size_t first, std::span<const Contact> of_pair) {
    const Contact& c = of_pair[0];
    if (first == 0 || c.a != contacts[first - 1].a) row_a = bodies.row_of(c.a);
    const std::size_t row_b = bodies.row_of(c.b);
    if (row_a < bodies.owned) owned_contacts += of_pair.size();
    involve(bodies, row_a);
    involve(bodies, row_b);
    if (!bodies_[row_a].moves && !bodies_[row_b].moves) return;  // solved by their owners
    ++bodies_[row_a].pairs;
    ++bodies_[row_b].pairs;
    pairs_.push_back({of_pair, first, row_a, row_b});
    pairs_.back().material = material_of(bodies, pairs_.back());
    pairs_.back().reduced_mass = 1 / (bodies_[row_a].inverse_mass + bodies_[row_b].inverse_mass);
  });
  return owned_contacts;
}

/// Sets targets, and velocities with the impulses of the last step applied.
void SffdResolver::start(const Step& step) {
  const BodySet& bodies = step.bodies;
  const std::vector<Twist>& before = step.velocities.before;
  impulses_.resize(step.contacts.size());
  targets_.resize(step.contacts.size());
  impact_changes_.resize(step.contacts.size());
  state_.resize(bodies.size() + 1);
  sums_.resize(bodies.size() + 1);
  state_.back() = {};
  for (const std::size_t row : involved_) {
    store(state_[row], step.velocities.now[row], bodies.is_dynamic(row) ? bodies_[row].pairs : 0);
    sums_[row] = {};
  }
  WarmStart stored(bodies);
  const auto fetch = [&](const Pair& p) { prefetch_impulses(bodies.stored_impulses[p.row_a]); };
  for_ahead(pairs_, pairs_ahead, fetch, [&](std::size_t n) {
    Pair& p = pairs_[n];
    for (std::size_t k = 0; k < p.contacts.size(); ++k) {
      const Contact& c = p.contacts[k];
      const Target t =
          target_of(c, step.dt, p.reduced_mass, before[p.row_b].at(c.r_b) - before[p.row_a].at(c.r_a));
      const bool has_rebounded = !step.velocities.rebounds.empty();
      targets_[p.first + k] =
          has_rebounded ? std::max(t.velocity, step.velocities.rebounds[p.first + k]) : t.velocity;
      impact_changes_[p.first + k] = t.impact_change;
      impulses_[p.first + k] = {};
    }
    if (settings_.warm_start) warm_start(p, step, stored);
  });
  for (const std::size_t row : locked_)
    step.velocities.on_locked.push_back({row, Vec3::Zero(), Vec3::Zero()});
  clear_locked_axes(&step.velocities.on_locked);
  for (const std::size_t row : involved_) apply_sum(state_[row], row, state_[row].number);
}

/// Returns the pair with the velocities of the last step.
CohesivePair SffdResolver::cohesive(const Pair& p, const Step& step) {
  const BodySet& bodies = step.bodies;
  const bool joined = p.contacts[0].lubrication || (bodies.is_dynamic(p.row_a) && bodies.is_dynamic(p.row_b));
  const std::vector<Twist>& before = step.velocities.before;
  return {*p.material, step.dt, p.contacts, joined, before[p.row_a], before[p.row_b]};
}

void SffdResolver::warm_start(Pair& p, const Step& step, WarmStart& stored) {
  const std::span impulses = impulses_of(p);
  const bool pulls = p.material && p.material->pulls();
  if (pulls) set_greatest_pulls(cohesive(p, step), impulses);
  if (bodies_[p.row_a].moves)
    stored.from_lower(p.row_a, p.contacts, impulses);
  else
    stored.from_higher(p.row_b, p.contacts, impulses);
  if (pulls) {
    set_pulls(cohesive(p, step), impulses);
    p.together = keep_together(cohesive(p, step), impulses, {targets_.data() + p.first, p.contacts.size()});
  }
  for (std::size_t k = 0; k < impulses.size(); ++k) {
    const Contact& c = p.contacts[k];
    const Vec3 impulse = impulses[k].along(c.normal);
    double& target = targets_[p.first + k];
    if (impulses[k].normal > 0) target = target_of_pressed(c, step.dt, target);
    add(sums_[p.row_a], c.r_a, -impulse);
    add(sums_[p.row_b], c.r_b, impulse);
  }
}

/// Returns the size below which impulses of a pair are rounding.
double SffdResolver::least_scale(const Pair& p) const {
  const auto speed = [&](std::size_t row) {
    const Twist t = twist_of(state_[row]);
    return std::max(t.v.norm(), bodies_[row].size * t.w.norm());
  };
  return p.reduced_mass * impulse_rounding * std::max(speed(p.row_a), speed(p.row_b));
}

/// Adds each pair with its shares of the bodies' masses.
void SffdResolver::lay_out(double dt, bool links_only) {
  lanes_.clear(bodies_.size() - 1);
  for (Pair& p : pairs_) {
    if (links_only && !p.link) continue;
    const double share_a = state_[p.row_a].number, share_b = state_[p.row_b].number;
    const Material* const rolling = p.material && !p.material->rolls_freely() ? p.material : nullptr;
    p.place = lanes_.add({.row_a = p.row_a,
                          .row_b = p.row_b,
                          .contacts = p.contacts,
                          .impulses = impulses_of(p),
                          .targets = targets_of(p),
                          .a = bodies_[p.row_a],
                          .b = bodies_[p.row_b],
                          .share_a = share_a,
                          .share_b = share_b,
                          .dt = dt,
                          .least_scale = least_scale(p),
                          .again = share_a > 1 || share_b > 1 || rolling,
                          .rolling = rolling,
                          .together = p.together});
  }
  lanes_.prepare();
}

/// Sends velocities and the number of pairs of each body to the partners.
void SffdResolver::share_pair_numbers(const Step& step) {
  for (const std::size_t row : involved_)
    if (row < step.bodies.owned) state_[row].number = bodies_[row].moves ? bodies_[row].pairs : 0;
  step.exchange.share(step.bodies, as_doubles(state_), state_width);
}

/// Returns whether the pair is part of a chain: one of its bodies has at most two pairs. (Contacts with a
/// film or with resistance to rolling are excluded: their impulses cannot be read back.)
bool SffdResolver::is_link(const Pair& p) const {
  const auto is_in_chain = [&](std::size_t row) {
    return bodies_[row].inverse_mass > 0 && state_[row].number <= 2;
  };
  return (is_in_chain(p.row_a) || is_in_chain(p.row_b)) && (!p.material || p.material->rolls_freely()) &&
         std::ranges::none_of(p.contacts, [](const Contact& c) { return bool(c.lubrication); });
}

/// Sweeps over chains until they converge. A load passes a chain body by body, the slower the larger the mass
/// ratio; a bed distributes it. Returns the number of sweeps; afterwards all pairs are in the lanes again.
int SffdResolver::settle_links(const Step& step) {
  for (Pair& p : pairs_)
    lanes_.read_impulses(p.place, impulses_of(p)), p.rolling = lanes_.read_rolling(p.place);
  share_pair_numbers(step);
  for (const std::size_t row : involved_) bodies_[row].pairs = 0;
  for (Pair& p : pairs_) {
    p.link = is_link(p);
    bodies_[p.row_a].pairs += p.link;
    bodies_[p.row_b].pairs += p.link;
  }
  share_pair_numbers(step);
  lay_out(step.dt, true);
  const auto [sweeps, residual] =
      sweep_to_rest(step, state_, {most_start_sweeps, most_start_sweeps, settings_.sweep_tolerance});
  for (const std::size_t row : involved_) bodies_[row].pairs = 0;
  for (const Pair& p : pairs_) {
    if (p.link) lanes_.read_impulses(p.place, impulses_of(p));
    ++bodies_[p.row_a].pairs;
    ++bodies_[p.row_b].pairs;
  }
  share_pair_numbers(step);
  lay_out(step.dt);
  return sweeps;
}

/// Applies the sum of a sweep to a body of this rank.
void SffdResolver::apply_sum(BodyState& s, std::size_t row, double number) const {
  if (!bodies_[row].moves) return;
  const Twist by = change_of(row);
  Eigen::Map<Vec3>{s.v} += by.v;
  Eigen::Map<Vec3>{s.w} += by.w;
  s.number = number;
  s.unused = 0;
}

/// Returns the largest change of velocity by the last sweep among this rank's bodies, at the centre or, by
/// rotation, at the radius of gyration.
double SffdResolver::largest_change() const {
  double largest = 0;  // squared
  for (const std::size_t row : involved_) {
    const Body& b = bodies_[row];
    if (!b.moves) continue;
    const Twist by = change_of(row);
    largest = std::max({largest, by.v.squaredNorm(), b.size * b.size * by.w.squaredNorm()});
  }
  return std::sqrt(largest);
}

/// Sweeps until the impulses have converged, on this rank and those connected by contacts.
SffdResolver::Rest SffdResolver::sweep_to_rest(const Step& step, std::vector<BodyState>& state,
                                               const Sweeps& sweeps) {
  CommonRest rest(step.exchange);
  Rest result;
  for (int i = 1;; ++i) {
    SweepOutcome found;
    if (!rest.idle()) {
      for (const std::size_t row : involved_) sums_[row] = {};
      const bool plain = i >= std::min(sweeps.most, sweeps.accelerated);
      found = lanes_.sweep(state, sums_, {i, plain, sweeps.push, sweeps.tolerance});
      clear_locked_axes(sweeps.push ? nullptr : &step.velocities.on_locked);
      for (const std::size_t row : involved_) apply_sum(state[row], row, sums_[row].changed);
    }
    if (found.solved) result.sweeps = i;
    result.residual = i >= sweeps.most && !rest.idle() ? largest_change() : 0;
    if (rest.reached(found.residual > sweeps.tolerance || found.carried) || i >= sweeps.most) return result;
    rest.share(step.bodies, as_doubles(state), state_width);
  }
}

/// Reports the part of a contact's impulse that reverses the approach; the rest carries load.
Vec3 SffdResolver::report_impact(BodySet& bodies, const Pair& p, std::size_t k) const {
  const double impulse =
      std::min(impulses_[p.first + k].normal, p.reduced_mass * impact_changes_[p.first + k]);
  return (*settings_.impacts)(bodies, {p.row_a, p.row_b, p.contacts[k].normal, impulse});
}

/// Returns whether an impulse in a lubrication film is mostly an impact, which is not stored.
bool SffdResolver::is_mostly_impact(const Pair& p, std::size_t k) const {
  return p.contacts[k].lubrication &&
         targets_[p.first + k] * p.reduced_mass > 0.5 * impulses_[p.first + k].normal;
}

/// `by_sink`: sum over the pair's impacts, on the second body; it acts at the first body's centre.
void SffdResolver::add_other_impulses(const Pair& p, const Vec3& by_sink, StepVelocities& velocities) const {
  const PairLanes::Rolling rolling = lanes_.read_rolling(p.place);
  const Vec3 impulse = rolling.impulse + p.rolling.impulse + by_sink;
  const Vec3 moment = rolling.moment + p.rolling.moment - p.contacts[0].r_a.cross(impulse);
  if (!impulse.isZero(0) || !moment.isZero(0))
    velocities.other_impulses.push_back({p.first, impulse, moment});
  for (std::size_t k = 0; k < p.contacts.size(); ++k) {
    const ContactImpulse& i = impulses_[p.first + k];
    const Vec3 all = i.along(p.contacts[k].normal);
    const bool is_remembered = i.normal > 0 || p.contacts[k].lubrication;  // not pulls alone
    if (is_mostly_impact(p, k) || (!is_remembered && !all.isZero(0)))
      velocities.other_impulses.push_back({p.first + k, all, Vec3::Zero()});
  }
}

/// Reads the impulses of a pair, for the next step and the statistics.
void SffdResolver::finish_pair(const Pair& p, const Step& step, ResolverStatistics& statistics) {
  const std::span impulses = impulses_of(p);
  lanes_.read_impulses(p.place, impulses);
  Vec3 by_sink = Vec3::Zero();
  for (std::size_t k = 0; k < impulses.size(); ++k) {
    const Contact& c = p.contacts[k];
    const ContactImpulse& i = impulses[k];
    statistics.penetration = std::max(statistics.penetration, -c.gap);
    if (i.normal > 0 && !c.lubrication)
      statistics.cone_excess = std::max(statistics.cone_excess, i.tangential.norm() / i.normal - c.friction);
    if (settings_.impacts && impact_changes_[p.first + k] > 0) by_sink += report_impact(step.bodies, p, k);
  }
  if (step.velocities.records_impulses(step.bodies, p.row_a, p.row_b))
    add_other_impulses(p, by_sink, step.velocities);
  for (std::size_t k = 0; k < impulses.size(); ++k)
    if (is_mostly_impact(p, k)) impulses[k] = {};
  if (!settings_.warm_start) return;
  auto& stored = step.bodies.stored_impulses;
  if (bodies_[p.row_a].moves) remember_impulses(p.contacts, impulses, p.contacts[0].b, stored[p.row_a]);
  if (bodies_[p.row_b].moves) remember_impulses(p.contacts, impulses, p.contacts[0].a, stored[p.row_b]);
}

/// Finishes pairs in key order, so that the bodies' lists are sorted by key.
void SffdResolver::finish(const Step& step, ResolverStatistics& statistics) {
  BodySet& bodies = step.bodies;
  for (std::size_t row = 0; row < bodies.owned; ++row) bodies.stored_impulses[row].clear();
  const auto fetch = [&](const Pair& p) {
    prefetch_impulses(bodies.stored_impulses[p.row_a]);
    prefetch_impulses(bodies.stored_impulses[p.row_b]);
  };
  for_ahead(pairs_, pairs_ahead, fetch, [&](std::size_t n) { finish_pair(pairs_[n], step, statistics); });
}

/// Returns whether an overlap needs correction, here or possibly on a connected rank.
bool SffdResolver::needs_correction(const Step& step) const {
  if (settings_.correction <= 0) return false;
  return !step.exchange.cluster().is_alone() ||
         std::ranges::any_of(step.contacts, [&](const Contact& c) { return is_correctable(c, settings_); });
}

/// Split impulses: the same sweeps without friction, for pseudo velocities that are used for positions only.
void SffdResolver::correct_positions(const Step& step) {
  step.exchange.share(step.bodies, as_doubles(state_), state_width);
  for (const Pair& p : pairs_) {
    const Twist a = twist_of(state_[p.row_a]), b = twist_of(state_[p.row_b]);
    for (std::size_t k = 0; k < p.contacts.size(); ++k) {
      const Contact& c = p.contacts[k];
      targets_[p.first + k] = target_of_push(c, step.dt, c.normal.dot(b.at(c.r_b) - a.at(c.r_a)), settings_);
    }
    lanes_.aim(p.place, targets_of(p), p.reduced_mass * push_rounding * lever_arms(p.contacts[0]) / step.dt);
  }
  push_.assign(step.bodies.size() + 1, BodyState{});
  sweep_to_rest(step, push_, {settings_.max_sweeps, accelerated_sweeps, push_tolerance, true});
  step.velocities.push.assign(step.bodies.size(), {});
  for (const std::size_t row : involved_)
    if (bodies_[row].moves) step.velocities.push[row] = twist_of(push_[row]);
}

ResolverStatistics SffdResolver::resolve(BodySet& bodies, const std::vector<Contact>& contacts, double dt,
                                         StepVelocities& velocities, BodyExchange& exchange) {
  const Step step{bodies, contacts, dt, velocities, exchange};
  ResolverStatistics statistics;
  velocities.push.clear(), velocities.on_locked.clear();
  statistics.contacts = collect_pairs(bodies, contacts);
  if (contacts.empty()) {
    finish(step, statistics);
    return statistics;
  }
  start(step);
  exchange.share(bodies, as_doubles(state_), state_width);
  lay_out(dt);
  const Rest rest =
      sweep_to_rest(step, state_, {settings_.max_sweeps, accelerated_sweeps, settings_.sweep_tolerance});
  statistics.sweeps = rest.sweeps;
  statistics.residual = rest.residual;
  if (velocities.start && settings_.warm_start) statistics.sweeps += settle_links(step);
  finish(step, statistics);
  for (const std::size_t row : involved_)
    if (bodies_[row].moves) velocities.now[row] = twist_of(state_[row]);
  if (needs_correction(step)) correct_positions(step);
  return statistics;
}

}  // namespace silt::rigid
