#include "rigid/response/impact_phase.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "rigid/bodies/body_exchange.hpp"
#include "rigid/math/elementary.hpp"

namespace silt::rigid {
namespace {

constexpr int share_width = 8;               // doubles per body in a share: v, w and the two below
constexpr int number = 6;                    // index: number of its colliding pairs in the round
constexpr int word = 7;                      // index: value of the current stage
constexpr double negligible = 1e-12;         // relative to the lever arms: least approach per step
constexpr double sweep_tolerance = 1e-13;    // relative change of a pair's impulses
constexpr double round_tolerance = 1e-15;    // the same within a pair
constexpr int most_rounds_of_a_pair = 1000;  // a single contact needs one

double response(double inverse_mass, const Mat3& inverse_inertia, const Vec3& r, const Vec3& d,
                const Vec3& along) {
  return inverse_mass * d.dot(along) + r.cross(d).dot(inverse_inertia * r.cross(along));
}

/// The two bodies of a pair while it is solved, with split masses.
struct Sides {
  Twist a, b;
  double mass_a, mass_b;  // inverse
  Mat3 inertia_a, inertia_b;

  void push(const Vec3& impulse, const Vec3& r_a, const Vec3& r_b) {
    a.v -= mass_a * impulse;
    a.w -= inertia_a * r_a.cross(impulse);
    b.v += mass_b * impulse;
    b.w += inertia_b * r_b.cross(impulse);
  }
  /// Returns the rounding error of a relative velocity at a contact.
  double rounding(const Vec3& r_a, const Vec3& r_b) const {
    return std::numeric_limits<double>::epsilon() *
           (a.v.norm() + a.w.norm() * r_a.norm() + b.v.norm() + b.w.norm() * r_b.norm());
  }
};

Twist read(const std::vector<double>& state, std::size_t row) {
  const double* s = state.data() + row * share_width;
  return {{s[0], s[1], s[2]}, {s[3], s[4], s[5]}};
}

void write(std::vector<double>& state, std::size_t row, const Twist& t) {
  double* s = state.data() + row * share_width;
  for (int d = 0; d < 3; ++d) {
    s[d] = t.v[d];
    s[3 + d] = t.w[d];
  }
}

}  // namespace

std::size_t ImpactPhase::involve(const BodySet& bodies, std::size_t row) {
  if (index_[row] < 0) {
    index_[row] = static_cast<std::int32_t>(bodies_.size());
    bodies_.push_back({.row = row,
                       .moves = row < bodies.owned && bodies.is_dynamic(row),
                       .inverse_mass = bodies.inverse_mass(row),
                       .inverse_inertia = bodies.inverse_inertia_W(row),
                       .start = {}});
  }
  return static_cast<std::size_t>(index_[row]);
}

/// Collects the pairs that can bounce.
void ImpactPhase::collect(const BodySet& bodies, const std::vector<Contact>& contacts) {
  bodies_.clear();
  pairs_.clear();
  contacts_.clear();
  index_.assign(bodies.size(), -1);
  for_each_pair(contacts, [&](std::size_t first, std::span<const Contact> of_pair) {
    const Contact& c = of_pair[0];
    if (!takes(c)) return;
    const std::size_t a = involve(bodies, bodies.row_of(c.a)), b = involve(bodies, bodies.row_of(c.b));
    if (!bodies_[a].moves && !bodies_[b].moves) return;  // solved by their owners
    // walls matter only if they rotate, which few do
    const bool b_turns = !is_wall(c.b) || bodies.angular_velocity[bodies_[b].row] != Vec3::Zero();
    const std::size_t from = contacts_.size();
    for (const Contact& of : of_pair)
      contacts_.push_back({.index = first + contacts_.size() - from,
                           .direction = contact_directions(of.normal),
                           .r_a = of.r_a,
                           .r_b = b_turns ? of.r_b : Vec3(Vec3::Zero()),
                           .gap = of.gap,
                           .friction = of.friction});
    pairs_.push_back({.first = from, .last = contacts_.size(), .a = a, .b = b, .restitution = c.restitution});
  });
}

/// Marks contacts that approach and touch, or would within the step. Returns whether there are any.
bool ImpactPhase::mark_approaching(double dt) {
  bool any = false;
  for (Pair& p : pairs_) {
    const Twist a = read(state_, bodies_[p.a].row), b = read(state_, bodies_[p.b].row);
    p.collides = false;
    for (std::size_t k = p.first; k < p.last; ++k) {
      ImpactContact& c = contacts_[k];
      const double speed = c.direction[0].dot(b.at(c.r_b) - a.at(c.r_a));
      const double least = negligible * (c.r_a.norm() + c.r_b.norm()) / dt;
      c.approaching = speed < -least && (c.gap <= 0 || c.gap + dt * speed < 0);
      p.collides = p.collides || c.approaching;
    }
    any = any || p.collides;
  }
  return any;
}

double& ImpactPhase::shared(const Body& b, int which) {
  return state_[b.row * share_width + which];
}

/// Selects the round's pairs: those whose restitution is the largest among approaching pairs of either body.
void ImpactPhase::choose_pairs(BodySet& bodies, BodyExchange& exchange) {
  for (const Body& b : bodies_) shared(b, word) = 0;
  for (const Pair& p : pairs_)
    for (const std::size_t end : {p.a, p.b})
      if (p.collides && bodies_[end].inverse_mass > 0)
        shared(bodies_[end], word) = std::max(shared(bodies_[end], word), p.restitution);
  exchange.share(bodies, state_, share_width);
  for (Pair& p : pairs_)
    p.collides = p.collides && p.restitution >= shared(bodies_[p.a], word) &&
                 p.restitution >= shared(bodies_[p.b], word);
}

/// Counts the round's pairs of each body and splits the masses accordingly.
void ImpactPhase::begin_round(BodySet& bodies, BodyExchange& exchange) {
  choose_pairs(bodies, exchange);
  for (Body& b : bodies_) {
    b.pairs = 0;
    b.start = read(state_, b.row);
  }
  for (const Pair& p : pairs_) {
    if (!p.collides) continue;
    ++bodies_[p.a].pairs;
    ++bodies_[p.b].pairs;
  }
  for (const Body& b : bodies_) shared(b, number) = b.pairs;
  exchange.share(bodies, state_, share_width);
  for (Pair& p : pairs_)
    if (p.collides) split_masses(p);
}

void ImpactPhase::split_masses(Pair& p) {
  const Body &a = bodies_[p.a], &b = bodies_[p.b];
  const double n_a = shared(a, number), n_b = shared(b, number);
  p.alone = (n_a == 1 || a.inverse_mass == 0) && (n_b == 1 || b.inverse_mass == 0);
  for (std::size_t k = p.first; k < p.last; ++k) {
    ImpactContact& c = contacts_[k];
    const auto& d = c.direction;
    const auto both = [&](int i, int j) {
      return n_a * response(a.inverse_mass, a.inverse_inertia, c.r_a, d[i], d[j]) +
             n_b * response(b.inverse_mass, b.inverse_inertia, c.r_b, d[i], d[j]);
    };
    const double k11 = both(1, 1), k22 = both(2, 2), k12 = both(1, 2);
    c.k_n = both(0, 0);
    c.k_t = 0.5 * (k11 + k22) + elementary::hypot(0.5 * (k11 - k22), k12);
    c.impulse = {};
  }
}

/// Solves a pair from the common velocities. Returns the change of its impulses relative to the largest.
double ImpactPhase::solve(const Pair& p, Stage stage) {
  const Body &body_a = bodies_[p.a], &body_b = bodies_[p.b];
  const double n_a = shared(body_a, number), n_b = shared(body_b, number);
  Sides sides{read(state_, body_a.row),  read(state_, body_b.row),     n_a * body_a.inverse_mass,
              n_b * body_b.inverse_mass, n_a * body_a.inverse_inertia, n_b * body_b.inverse_inertia};
  old_.clear();
  double rounding = 0;  // of impulses
  for (std::size_t k = p.first; k < p.last; ++k) {
    const ImpactContact& c = contacts_[k];
    old_.push_back(c.impulse);
    rounding = std::max(rounding, sides.rounding(c.r_a, c.r_b) / std::min(c.k_n, c.k_t));
  }
  for (int i = 0; i < most_rounds_of_a_pair; ++i) {
    double change = 0, scale = 0;
    for (std::size_t k = p.first; k < p.last; ++k) {
      ImpactContact& c = contacts_[k];
      if (!c.approaching) continue;
      const Vec3 u = sides.b.at(c.r_b) - sides.a.at(c.r_a);
      auto& impulse = c.impulse;
      const std::array<double, 3> before = impulse;
      if (stage == Stage::normal) {
        impulse[0] = std::max(0.0, impulse[0] - c.direction[0].dot(u) / c.k_n);
      } else {
        for (int d = 1; d < 3; ++d) impulse[d] -= c.direction[d].dot(u) / c.k_t;
        const double size = elementary::hypot(impulse[1], impulse[2]), limit = c.friction * impulse[0];
        if (size > limit)
          for (int d = 1; d < 3; ++d) impulse[d] *= limit / size;
      }
      Vec3 difference = Vec3::Zero();
      for (int d = 0; d < 3; ++d) difference += (impulse[d] - before[d]) * c.direction[d];
      sides.push(difference, c.r_a, c.r_b);
      change = std::max(change, difference.norm());
      scale = std::max({scale, std::abs(impulse[0]), std::abs(impulse[1]), std::abs(impulse[2])});
    }
    if (p.last - p.first == 1 && stage == Stage::normal) break;
    if (change <= std::max(round_tolerance * scale, rounding)) break;
  }
  double change = 0, scale = 0;
  for (std::size_t k = p.first; k < p.last; ++k)
    for (int d = 0; d < 3; ++d) {
      change = std::max(change, std::abs(contacts_[k].impulse[d] - old_[k - p.first][d]));
      scale = std::max(scale, std::abs(contacts_[k].impulse[d]));
    }
  return change > 0 ? change / scale : 0;
}

/// Adds the change of the pair's impulses to its two bodies.
void ImpactPhase::apply_change(const Pair& p, const std::vector<std::array<double, 3>>& old) {
  Body &a = bodies_[p.a], &b = bodies_[p.b];
  a.pushed = b.pushed = true;
  for (std::size_t k = p.first; k < p.last; ++k) {
    const ImpactContact& c = contacts_[k];
    Vec3 impulse = Vec3::Zero();
    for (int d = 0; d < 3; ++d)
      impulse += (c.impulse[d] - (old.empty() ? 0.0 : old[k - p.first][d])) * c.direction[d];
    a.impulse -= impulse;
    a.angular_impulse -= c.r_a.cross(impulse);
    b.impulse += impulse;
    b.angular_impulse += c.r_b.cross(impulse);
  }
}

/// Applies the impulses to the bodies with their true masses.
void ImpactPhase::apply() {
  for (Body& b : bodies_) {
    if (b.moves && b.pushed) {
      Twist t = read(state_, b.row);
      t.v += b.inverse_mass * b.impulse;
      t.w += b.inverse_inertia * b.angular_impulse;
      write(state_, b.row, t);
    }
    b.impulse = b.angular_impulse = Vec3::Zero();
    b.pushed = false;
  }
}

/// A pair is solved in the first sweep, and later if one of its bodies has changed since.
bool ImpactPhase::needs_solution(const Pair& p, Stage stage, int sweep) {
  if (!p.collides || (stage == Stage::tangential && contacts_[p.first].friction <= 0)) return false;
  return sweep == 1 || (!p.alone && (shared(bodies_[p.a], word) != 0 || shared(bodies_[p.b], word) != 0));
}

/// Returns whether a pair has changed. Changed bodies send this to their partners.
bool ImpactPhase::sweep(Stage stage, int sweep) {
  bool moving = false;
  for (Body& b : bodies_) b.changed = false;
  for (const Pair& p : pairs_) {
    if (!needs_solution(p, stage, sweep)) continue;
    const bool changed = solve(p, stage) > sweep_tolerance && !p.alone;
    for (const std::size_t end : {p.a, p.b}) bodies_[end].changed = bodies_[end].changed || changed;
    moving = moving || changed;
    apply_change(p, old_);
  }
  apply();
  for (const Body& b : bodies_) shared(b, word) = b.moves && b.changed;
  return moving;
}

/// Sweeps at least once and at most most_sweeps_ times; bodies that have not converged by then are marked by
/// their word. Returns the number of sweeps.
int ImpactPhase::sweep_to_rest(BodySet& bodies, BodyExchange& exchange, Stage stage) {
  CommonRest rest(exchange);
  for (int i = 1;; ++i) {
    const bool at_rest = rest.reached(sweep(stage, i));
    rest.share(bodies, state_, share_width);
    cut_short_ = !at_rest;
    if (at_rest || i >= most_sweeps_) return i;
  }
}

/// Spreads the word of any body through its cluster of colliding bodies.
void ImpactPhase::spread_word(BodySet& bodies, BodyExchange& exchange) {
  CommonRest rest(exchange);
  for (bool at_rest = false; !at_rest;) {
    bool moving = false;
    for (const Pair& p : pairs_) {
      const double heard = std::max(shared(bodies_[p.a], word), shared(bodies_[p.b], word));
      for (const std::size_t end : {p.a, p.b}) {
        if (!p.collides || !bodies_[end].moves || shared(bodies_[end], word) == heard) continue;
        shared(bodies_[end], word) = heard;
        moving = true;
      }
    }
    at_rest = rest.reached(moving);
    rest.share(bodies, state_, share_width);
  }
}

/// Multiplies plastic impulses by 1 + e, from the round's first velocities, except in unconverged clusters.
void ImpactPhase::rebound(BodySet& bodies, BodyExchange& exchange) {
  if (cut_short_) spread_word(bodies, exchange);
  for (const Body& b : bodies_)
    if (b.moves) write(state_, b.row, b.start);
  for (const Pair& p : pairs_) {
    if (!p.collides) continue;
    const bool settled = shared(bodies_[p.a], word) == 0 && shared(bodies_[p.b], word) == 0;
    for (std::size_t k = p.first; k < p.last; ++k)
      contacts_[k].impulse[0] *= settled ? 1 + p.restitution : 1.0;
    apply_change(p, {});
  }
  apply();
  exchange.share(bodies, state_, share_width);
}

/// Adds the impulses of a finished round.
void ImpactPhase::add_round() {
  for (const Pair& p : pairs_)
    for (std::size_t k = p.first; k < p.last && p.collides; ++k)
      for (int d = 0; d < 3; ++d) contacts_[k].given += contacts_[k].impulse[d] * contacts_[k].direction[d];
}

/// Stores the impulses of impacts, and the separation velocities of their contacts.
void ImpactPhase::store_impacts(const BodySet& bodies, std::size_t contacts,
                                StepVelocities& velocities) const {
  const auto was_hit = [](const ImpactContact& c) { return !c.given.isZero(0); };
  velocities.rebounds.clear();
  if (std::ranges::none_of(contacts_, was_hit)) return;
  velocities.rebounds.assign(contacts, std::numeric_limits<double>::lowest());
  for (const Pair& p : pairs_) {
    const Body &a = bodies_[p.a], &b = bodies_[p.b];
    const Twist twist_a = read(state_, a.row), twist_b = read(state_, b.row);
    const bool tells = velocities.records_impulses(bodies, a.row, b.row);
    for (std::size_t k = p.first; k < p.last; ++k) {
      const ImpactContact& c = contacts_[k];
      if (!was_hit(c)) continue;
      velocities.rebounds[c.index] = c.direction[0].dot(twist_b.at(c.r_b) - twist_a.at(c.r_a));
      if (tells) velocities.other_impulses.push_back({c.index, c.given, Vec3::Zero()});
    }
  }
}

bool ImpactPhase::has_friction() const {
  return std::ranges::any_of(pairs_,
                             [&](const Pair& p) { return p.collides && contacts_[p.first].friction > 0; });
}

int ImpactPhase::operator()(BodySet& bodies, const std::vector<Contact>& contacts, double dt,
                            StepVelocities& velocities, BodyExchange& exchange) {
  collect(bodies, contacts);
  state_.assign(bodies.size() * share_width, 0.0);
  for (const Body& b : bodies_) write(state_, b.row, velocities.before[b.row]);
  int sweeps = 0;
  for (int round = 0; round < most_sweeps_; ++round) {
    if (!on_any(bodies, exchange, mark_approaching(dt))) break;
    begin_round(bodies, exchange);
    sweeps += sweep_to_rest(bodies, exchange, Stage::normal);
    rebound(bodies, exchange);
    if (on_any(bodies, exchange, has_friction()))
      sweeps += sweep_to_rest(bodies, exchange, Stage::tangential);
    add_round();
  }
  store_impacts(bodies, contacts.size(), velocities);
  for (const Body& b : bodies_) {
    const Twist after = read(state_, b.row);
    Twist &before = velocities.before[b.row], &now = velocities.now[b.row];
    if (b.moves && after.v != before.v) now.v += after.v - before.v;
    if (b.moves && after.w != before.w) now.w += after.w - before.w;
    before = after;
  }
  return sweeps;
}

ResolverStatistics ImpactThenContact::resolve(BodySet& bodies, const std::vector<Contact>& contacts,
                                              double dt, StepVelocities& velocities, BodyExchange& exchange) {
  const int sweeps = impact_(bodies, contacts, dt, velocities, exchange);
  plastic_ = contacts;
  for (Contact& c : plastic_)
    if (impact_.takes(c)) c.restitution = 0;
  ResolverStatistics statistics = contact_->resolve(bodies, plastic_, dt, velocities, exchange);
  statistics.impact_sweeps = sweeps;
  return statistics;
}

}  // namespace silt::rigid
