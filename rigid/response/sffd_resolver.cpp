#include "rigid/response/sffd_resolver.hpp"

#include <algorithm>
#include <cmath>

#include "cpu/prefetch.hpp"
#include "rigid/response/common_rest.hpp"
#include "rigid/response/held_impulses.hpp"

namespace silt::rigid {

namespace {

constexpr int state_width = sizeof(BodyState) / sizeof(double);  // doubles a body in a share
/// Times mass x speed: an impulse this small says nothing about convergence.
constexpr double impulse_rounding = 1e-5;
constexpr int accelerated_sweeps = 64;       // what is not at rest by then does better without
constexpr int most_start_sweeps = 10000;     // of chains at the start: a ratio of masses of 10^4 takes 9000
constexpr double push_tolerance = 1e-3;      // of the position correction's impulses, relative
constexpr double push_rounding = 1e-7;       // displacement of a step, relative to the contact's lever arms
constexpr double negligible_overlap = 1e-9;  // relative to the contact's lever arms: left alone
constexpr int pairs_ahead = 8;               // that much later memory has answered
constexpr double hair = 1e-4;                // gap a pressed contact may keep, relative to its lever arms

Vec3 velocity(const BodyState& s) {
  return {s.v[0], s.v[1], s.v[2]};
}
Vec3 angular_velocity(const BodyState& s) {
  return {s.w[0], s.w[1], s.w[2]};
}
Vec3 velocity_at(const BodyState& s, const Vec3& r) {
  return velocity(s) + angular_velocity(s).cross(r);
}

void store(BodyState& s, const Vec3& v, const Vec3& w, double number) {
  Eigen::Map<Vec3>{s.v} = v;
  Eigen::Map<Vec3>{s.w} = w;
  s.number = number;
  s.unused = 0;
}

std::span<double> as_doubles(std::vector<BodyState>& state) {
  return {&state.data()->v[0], (state.size() - 1) * state_width};  // not the one at rest
}

/// Least normal velocity after the step (C1): what closes the gap, or what Newton's restitution asks
/// of a contact that would be reached, from the velocities before the kick (so that a body at rest does not
/// bounce) and what a lubrication film leaves of them.
struct Target {
  double velocity;
  double impact_change = 0;  // of the velocity, where the contact is hit
};
Target target_of(const Contact& c, double dt, double reduced_mass, const Vec3& before) {
  const double closing = c.gap > 0 ? -c.gap / dt : 0.0;
  const double speed = c.normal.dot(before) / (1 + dt * c.lubrication.normal / reduced_mass);
  const bool hits = speed < 0 && (c.gap <= 0 || c.gap + dt * speed < 0);
  if (!hits) return {closing};
  const double target = std::max(closing, -c.restitution * speed);
  return {target, target - speed};
}

double lever_arms(const Contact& c) {
  return is_wall(c.b) ? c.r_a.norm() : c.r_a.norm() + c.r_b.norm();
}

/// The target of a contact that pressed in the last step: one that has opened by a hair is held, not let
/// fall. Else the load shifts to the contacts that are left and back again, and stacks rock and creep. A
/// lubrication film holds by itself, and its impulse does not mean that the surfaces touched.
double target_of_pressed(const Contact& c, double dt, double target) {
  return c.gap > 0 && !c.lubrication ? std::max(target, std::min(0.0, hair * lever_arms(c) - c.gap) / dt)
                                     : target;
}

/// Lists of single bodies lie anywhere in memory. The lines fetched are where a body's first few begin.
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
  const bool free = bodies.is_free(row);
  b.moves = row < bodies.owned && free;
  b.asks_for_impulses = row < bodies.owned && bodies.is_dynamic(row);
  b.inverse_mass = bodies.inverse_mass(row);
  b.inverse_inertia = bodies.inverse_inertia_W(row);
  b.isotropic = !free || bodies.is_isotropic(row);
  b.turns = free || bodies.angular_velocity[row] != Vec3::Zero();
  b.size = std::sqrt(bodies.inertia_B[row].trace() / (3 * bodies.mass[row]));
}

/// Returns the number of contacts whose lower body is owned.
std::size_t SffdResolver::collect_pairs(BodySet& bodies, const std::vector<Contact>& contacts) {
  std::size_t owned_contacts = 0;
  pairs_.clear();
  for (const std::size_t row : involved_) bodies_[row].involved = false;
  bodies_.resize(bodies.size() + 1);
  involved_.clear();
  std::size_t row_a = 0;
  for (std::size_t first = 0, last; first < contacts.size(); first = last) {
    const Contact& c = contacts[first];
    for (last = first + 1; last < contacts.size() && contacts[last].pair() == c.pair();) ++last;
    if (first == 0 || c.a != contacts[first - 1].a) row_a = bodies.row_of(c.a);
    const std::size_t row_b = bodies.row_of(c.b);
    if (row_a < bodies.owned) owned_contacts += last - first;
    involve(bodies, row_a);
    involve(bodies, row_b);
    if (!bodies_[row_a].asks_for_impulses && !bodies_[row_b].asks_for_impulses)
      continue;  // its owners' business
    const bool moves = bodies.is_free(row_a) || bodies.is_free(row_b);
    hold_or_release(bodies, row_a, {&c, last - first}, !moves);
    hold_or_release(bodies, row_b, {&c, last - first}, !moves);
    if (!moves) continue;
    ++bodies_[row_a].pairs;
    ++bodies_[row_b].pairs;
    pairs_.push_back({first, last, row_a, row_b});
    pairs_.back().reduced_mass = 1 / (bodies_[row_a].inverse_mass + bodies_[row_b].inverse_mass);
  }
  return owned_contacts;
}

/// Targets, and velocities with the impulses of the step before.
void SffdResolver::start(const BodySet& bodies, const std::vector<Contact>& contacts, double dt,
                         const StepVelocities& velocities) {
  const auto before = [&](std::size_t row, const Vec3& r) -> Vec3 {
    return velocities.before_v[row] + velocities.before_w[row].cross(r);
  };
  impulses_.resize(contacts.size());
  targets_.resize(contacts.size());
  impact_changes_.resize(contacts.size());
  state_.resize(bodies.size() + 1);
  sums_.resize(bodies.size() + 1);
  state_.back() = {};
  for (const std::size_t row : involved_) {
    store(state_[row], velocities.v[row], velocities.w[row], bodies.is_free(row) ? bodies_[row].pairs : 0);
    sums_[row] = {};
  }
  Recall recall(bodies);
  const auto fetch = [&](const Pair& p) { prefetch_impulses(bodies.stored_impulses[p.row_a]); };
  for_ahead(pairs_, pairs_ahead, fetch, [&](std::size_t k) {
    const Pair& p = pairs_[k];
    const std::span of_pair(contacts.data() + p.first, p.last - p.first);
    for (std::size_t i = p.first; i < p.last; ++i) {
      const Contact& c = contacts[i];
      const Target t = target_of(c, dt, p.reduced_mass, before(p.row_b, c.r_b) - before(p.row_a, c.r_a));
      targets_[i] = t.velocity;
      impact_changes_[i] = t.impact_change;
      impulses_[i] = {};
    }
    if (settings_.warm_start) warm_start(p, of_pair, dt, recall);
  });
  for (const std::size_t row : involved_) take_sum(state_[row], row, state_[row].number);
}

void SffdResolver::warm_start(const Pair& p, std::span<const Contact> contacts, double dt, Recall& recall) {
  const std::span impulses = impulses_of(p);
  if (bodies_[p.row_a].asks_for_impulses)
    recall.of_lower(p.row_a, contacts, impulses);
  else
    recall.of_higher(p.row_b, contacts, impulses);
  for (std::size_t k = 0; k < contacts.size(); ++k) {
    const Vec3 impulse = impulses[k].along(contacts[k].normal);
    double& target = targets_[p.first + k];
    if (impulses[k].normal > 0) target = target_of_pressed(contacts[k], dt, target);
    add(sums_[p.row_a], contacts[k].r_a, -impulse);
    add(sums_[p.row_b], contacts[k].r_b, impulse);
  }
}

/// Impulses of a pair below this are rounding.
double SffdResolver::least_scale(const Pair& p) const {
  const auto speed = [&](std::size_t row) {
    const BodyState& s = state_[row];
    return std::max(velocity(s).norm(), bodies_[row].size * angular_velocity(s).norm());
  };
  return p.reduced_mass * impulse_rounding * std::max(speed(p.row_a), speed(p.row_b));
}

/// Each pair with the share of its bodies' masses that it has to itself.
void SffdResolver::lay_out(const std::vector<Contact>& contacts, double dt, bool links_only) {
  lanes_.clear(bodies_.size() - 1);
  for (Pair& p : pairs_) {
    if (links_only && !p.link) continue;
    const std::size_t count = p.last - p.first;
    const bool again = state_[p.row_a].number > 1 || state_[p.row_b].number > 1;
    p.place = lanes_.add({p.row_a,
                          p.row_b,
                          {contacts.data() + p.first, count},
                          impulses_of(p),
                          {targets_.data() + p.first, count},
                          bodies_[p.row_a],
                          bodies_[p.row_b],
                          state_[p.row_a].number,
                          state_[p.row_b].number,
                          dt,
                          least_scale(p),
                          again});
  }
  lanes_.prepare();
}

std::span<ContactImpulse> SffdResolver::impulses_of(const Pair& p) {
  return {impulses_.data() + p.first, p.last - p.first};
}

/// Tells the partners among how many pairs a body is divided, with its velocities.
void SffdResolver::share_pair_numbers(BodySet& bodies, BodyExchange& exchange) {
  for (const std::size_t row : involved_)
    if (row < bodies.owned) state_[row].number = bodies_[row].moves ? bodies_[row].pairs : 0;
  exchange.share(bodies, as_doubles(state_), state_width);
}

/// A pair of a chain: one of its bodies has no more than two. (A film has no impulse that could be solved
/// for once more.)
bool SffdResolver::is_link(const Pair& p, std::span<const Contact> contacts) const {
  const auto is_in_chain = [&](std::size_t row) {
    return bodies_[row].inverse_mass > 0 && state_[row].number <= 2;
  };
  return (is_in_chain(p.row_a) || is_in_chain(p.row_b)) &&
         std::none_of(contacts.begin(), contacts.end(), [](const Contact& c) { return bool(c.lubrication); });
}

/// Sweeps over chains until they are at rest. A load passes a chain body by body, the slower the more the
/// masses differ; a bed shares it. Returns how many sweeps there were; all pairs are laid out again.
int SffdResolver::settle_links(BodySet& bodies, const std::vector<Contact>& contacts, double dt,
                               BodyExchange& exchange) {
  for (const Pair& p : pairs_) lanes_.read_impulses(p.place, impulses_of(p));
  share_pair_numbers(bodies, exchange);
  for (const std::size_t row : involved_) bodies_[row].pairs = 0;
  for (Pair& p : pairs_) {
    p.link = is_link(p, {contacts.data() + p.first, p.last - p.first});
    bodies_[p.row_a].pairs += p.link;
    bodies_[p.row_b].pairs += p.link;
  }
  share_pair_numbers(bodies, exchange);
  lay_out(contacts, dt, true);
  double residual = 0;
  const int sweeps = sweep_to_rest(
      bodies, exchange, state_, {most_start_sweeps, most_start_sweeps, settings_.sweep_tolerance}, residual);
  for (const std::size_t row : involved_) bodies_[row].pairs = 0;
  for (const Pair& p : pairs_) {
    if (p.link) lanes_.read_impulses(p.place, impulses_of(p));
    ++bodies_[p.row_a].pairs;
    ++bodies_[p.row_b].pairs;
  }
  share_pair_numbers(bodies, exchange);
  lay_out(contacts, dt);
  return sweeps;
}

/// Moves a body this rank owns.
void SffdResolver::take_sum(BodyState& s, std::size_t row, double number) const {
  const Body& b = bodies_[row];
  if (!b.moves) return;
  const BodySum& sum = sums_[row];
  store(s, velocity(s) + b.inverse_mass * Eigen::Map<const Vec3>(sum.impulse),
        angular_velocity(s) + b.inverse_inertia * Eigen::Map<const Vec3>(sum.angular), number);
}

/// Returns the largest velocity that the last sweep gave a body of this rank, or a point of it at its radius
/// of gyration.
double SffdResolver::largest_change(const BodySet& bodies) const {
  double largest = 0;  // squared
  for (const std::size_t row : involved_) {
    const Body& b = bodies_[row];
    if (row >= bodies.owned || !b.moves) continue;
    const Vec3 v = b.inverse_mass * Eigen::Map<const Vec3>(sums_[row].impulse),
               w = b.inverse_inertia * Eigen::Map<const Vec3>(sums_[row].angular);
    largest = std::max({largest, v.squaredNorm(), b.size * b.size * w.squaredNorm()});
  }
  return std::sqrt(largest);
}

/// Sweeps until the impulses are at rest, here and on the ranks that contacts connect this one with. Returns
/// the number of the last sweep that solved anything here.
int SffdResolver::sweep_to_rest(BodySet& bodies, BodyExchange& exchange, std::vector<BodyState>& state,
                                const Sweeps& sweeps, double& residual) {
  CommonRest rest(exchange);
  int last = 0;
  for (int i = 1;; ++i) {
    SweepOutcome found;
    if (!rest.idle()) {
      for (const std::size_t row : involved_) sums_[row] = {};
      const bool plain = i >= std::min(sweeps.most, sweeps.accelerated);
      found = lanes_.sweep(state, sums_, {i, plain, sweeps.push, sweeps.tolerance});
      for (const std::size_t row : involved_) take_sum(state[row], row, sums_[row].changed);
    }
    if (found.solved) last = i;
    residual = i >= sweeps.most && !rest.idle() ? largest_change(bodies) : 0;
    if (rest.reached(found.residual > sweeps.tolerance || found.carried) || i >= sweeps.most) return last;
    rest.share(bodies, as_doubles(state), state_width);
  }
}

/// (C7): b_n >= share of the overlap that the velocity does not take back by itself; an open contact
/// may use up the gap that is left.
void SffdResolver::aim_push(const std::vector<Contact>& contacts, double dt) {
  for (const Pair& p : pairs_) {
    for (std::size_t k = p.first; k < p.last; ++k) {
      const Contact& c = contacts[k];
      const double u =
          c.normal.dot(velocity_at(state_[p.row_b], c.r_b) - velocity_at(state_[p.row_a], c.r_a));
      const double overlap = settings_.correction * (-c.gap - settings_.slop) / dt - std::max(0.0, u);
      if (c.gap > 0)
        targets_[k] = std::min(0.0, -(c.gap / dt + u));
      else
        targets_[k] = is_correctable(c) ? std::max(0.0, overlap) : 0;
    }
    lanes_.aim(p.place, {targets_.data() + p.first, p.last - p.first},
               p.reduced_mass * push_rounding * lever_arms(contacts[p.first]) / dt);
  }
}

/// The part of a contact's impulse that reverses the approach of its bodies; what it holds besides is load.
Vec3 SffdResolver::report_impact(BodySet& bodies, const Pair& p, std::size_t contact,
                                 const Vec3& normal) const {
  const double impulse = std::min(impulses_[contact].normal, p.reduced_mass * impact_changes_[contact]);
  return (*settings_.impacts)(bodies, {p.row_a, p.row_b, normal, impulse});
}

/// What does not last is not remembered.
bool SffdResolver::is_mostly_impact(const Pair& p, std::size_t contact) const {
  return targets_[contact] * p.reduced_mass > 0.5 * impulses_[contact].normal;
}

/// `by_sink`: sum over the pair's impacts, on the wall; they act about the body's centre.
void SffdResolver::note_other_wall_impulse(const Pair& p, std::span<const Contact> of_pair,
                                           const Vec3& by_sink, StepVelocities& velocities) const {
  const PairLanes::Rolling rolling = lanes_.read_rolling(p.place);
  OtherWallImpulse other{of_pair[0].b, of_pair[0].image, p.row_a, rolling.impulse + by_sink, rolling.moment};
  for (std::size_t k = 0; k < of_pair.size(); ++k) {
    if (!of_pair[k].lubrication || !is_mostly_impact(p, p.first + k)) continue;
    const Vec3 impulse = impulses_[p.first + k].along(of_pair[k].normal);
    other.impulse += impulse;
    other.moment += of_pair[k].r_a.cross(impulse);
  }
  if (!other.impulse.isZero(0) || !other.moment.isZero(0)) velocities.other_wall_impulses.push_back(other);
}

/// An overlap that a correction is worth.
bool SffdResolver::is_correctable(const Contact& c) const {
  return settings_.correction > 0 && -c.gap > settings_.slop &&
         -c.gap > settings_.slop + negligible_overlap * lever_arms(c);
}

/// Reads the impulses, for the next step and for the statistics.
void SffdResolver::finish(BodySet& bodies, const std::vector<Contact>& contacts, StepVelocities& velocities,
                          ResolverStatistics& statistics) {
  forget_last_impulses(bodies, involved_);
  velocities.other_wall_impulses.clear();
  const auto fetch = [&](const Pair& p) {
    prefetch_impulses(bodies.stored_impulses[p.row_a]);
    prefetch_impulses(bodies.stored_impulses[p.row_b]);
  };
  for_ahead(pairs_, pairs_ahead, fetch, [&](std::size_t n) {  // in key order: lists of bodies come out sorted
    const Pair& p = pairs_[n];
    const std::span of_pair(contacts.data() + p.first, p.last - p.first);
    const std::span impulses = impulses_of(p);
    lanes_.read_impulses(p.place, impulses);
    if (!velocities.load.empty()) add_load(bodies, p.row_a, p.row_b, of_pair, impulses, velocities);
    Vec3 by_sink = Vec3::Zero();
    for (std::size_t k = 0; k < impulses.size(); ++k) {
      const Contact& c = of_pair[k];
      const ContactImpulse& i = impulses[k];
      statistics.penetration = std::max(statistics.penetration, -c.gap);
      if (i.normal > 0 && !c.lubrication)
        statistics.cone_excess =
            std::max(statistics.cone_excess, i.tangential.norm() / i.normal - c.friction);
      if (settings_.impacts && impact_changes_[p.first + k] > 0)
        by_sink += report_impact(bodies, p, p.first + k, c.normal);
    }
    if (is_wall(of_pair[0].b)) note_other_wall_impulse(p, of_pair, by_sink, velocities);
    for (std::size_t k = 0; k < impulses.size(); ++k)
      if (of_pair[k].lubrication && is_mostly_impact(p, p.first + k)) impulses[k] = {};
    if (!settings_.warm_start) return;
    if (bodies_[p.row_a].asks_for_impulses)
      remember_impulses(of_pair, impulses, of_pair[0].b, bodies.stored_impulses[p.row_a]);
    if (bodies_[p.row_b].asks_for_impulses)
      remember_impulses(of_pair, impulses, of_pair[0].a, bodies.stored_impulses[p.row_b]);
  });
  for (const std::size_t row : involved_)
    if (row < bodies.owned && bodies.keeps_impulses(row)) sort_by_partner(bodies.stored_impulses[row]);
}

/// Whether an overlap here is to be corrected, or may be on a rank that contacts connect this one with.
/// (Where none is, a correction changes nothing.)
bool SffdResolver::is_to_correct(const std::vector<Contact>& contacts, const BodyExchange& exchange) const {
  if (settings_.correction <= 0) return false;
  return !exchange.cluster().is_alone() ||
         std::any_of(contacts.begin(), contacts.end(), [&](const Contact& c) { return is_correctable(c); });
}

/// Split impulses: the same sweeps, frictionless, for velocities that move bodies apart and are then
/// forgotten.
void SffdResolver::correct_positions(BodySet& bodies, const std::vector<Contact>& contacts, double dt,
                                     StepVelocities& velocities, BodyExchange& exchange) {
  exchange.share(bodies, as_doubles(state_), state_width);
  aim_push(contacts, dt);
  push_.assign(bodies.size() + 1, BodyState{});
  double residual = 0;
  sweep_to_rest(bodies, exchange, push_, {settings_.max_sweeps, accelerated_sweeps, push_tolerance, true},
                residual);
  velocities.push_v.assign(bodies.size(), Vec3::Zero());
  velocities.push_w.assign(bodies.size(), Vec3::Zero());
  for (const std::size_t row : involved_) {
    if (!bodies_[row].moves) continue;
    velocities.push_v[row] = velocity(push_[row]);
    velocities.push_w[row] = angular_velocity(push_[row]);
  }
}

ResolverStatistics SffdResolver::resolve(BodySet& bodies, const std::vector<Contact>& contacts, double dt,
                                         StepVelocities& velocities, BodyExchange& exchange) {
  ResolverStatistics statistics;
  velocities.push_v.clear();
  velocities.push_w.clear();
  statistics.contacts = collect_pairs(bodies, contacts);
  if (contacts.empty()) {
    finish(bodies, contacts, velocities, statistics);
    return statistics;
  }
  start(bodies, contacts, dt, velocities);
  exchange.share(bodies, as_doubles(state_), state_width);
  lay_out(contacts, dt);
  statistics.sweeps = sweep_to_rest(bodies, exchange, state_,
                                    {settings_.max_sweeps, accelerated_sweeps, settings_.sweep_tolerance},
                                    statistics.residual);
  if (velocities.start && settings_.warm_start)
    statistics.sweeps += settle_links(bodies, contacts, dt, exchange);
  finish(bodies, contacts, velocities, statistics);
  for (const std::size_t row : involved_) {
    if (!bodies_[row].moves) continue;
    velocities.v[row] = velocity(state_[row]);
    velocities.w[row] = angular_velocity(state_[row]);
  }
  if (is_to_correct(contacts, exchange)) correct_positions(bodies, contacts, dt, velocities, exchange);
  return statistics;
}

}  // namespace silt::rigid
