#include "rigid/response/impact_phase.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "rigid/bodies/body_exchange.hpp"
#include "rigid/math/elementary.hpp"

namespace silt::rigid {
namespace {

constexpr int share_width = 8;               // doubles a body in a share: v, w and the two that follow
constexpr int number = 6;                    // of its pairs that collide in the round
constexpr int word = 7;                      // what the stage at hand has to tell its partners
constexpr double negligible = 1e-12;         // approach in a step, relative to the lever arms: none
constexpr double sweep_tolerance = 1e-13;    // change of a pair's impulses, relative to the largest
constexpr double round_tolerance = 1e-15;    // the same inside a pair
constexpr int most_rounds_of_a_pair = 1000;  // inside a pair; a single contact needs one

double response(double inverse_mass, const Mat3& inverse_inertia, const Vec3& r, const Vec3& d,
                const Vec3& along) {
  return inverse_mass * d.dot(along) + r.cross(d).dot(inverse_inertia * r.cross(along));
}

/// Two bodies while their pair is solved: with split masses.
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
  /// Returns the rounding of the difference of two velocities at a contact.
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

/// The pairs that can bounce.
void ImpactPhase::collect(const BodySet& bodies, const std::vector<Contact>& contacts) {
  bodies_.clear();
  pairs_.clear();
  contacts_.clear();
  index_.assign(bodies.size(), -1);
  for_each_pair(contacts, [&](std::size_t first, std::span<const Contact> of_pair) {
    const Contact& c = of_pair[0];
    if (!takes(c)) return;
    const std::size_t a = involve(bodies, bodies.row_of(c.a)), b = involve(bodies, bodies.row_of(c.b));
    if (!bodies_[a].moves && !bodies_[b].moves) return;  // its owners' business
    // of a wall only its turning matters, and few turn
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

/// Marks the contacts that approach and touch, or would within the step. Returns whether there are any.
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

/// Picks the round's pairs: those whose restitution no approaching pair of either body exceeds.
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

/// Counts the round's pairs at their bodies and splits the masses accordingly.
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

/// Solves one pair from the common velocities. Returns how much its impulses changed, relative to the
/// largest.
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

/// Adds what the pair's impulses changed by to its two bodies.
void ImpactPhase::take_impulses(const Pair& p, const std::vector<std::array<double, 3>>& old) {
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

/// Bodies take the impulses with their true masses.
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

/// A pair is solved in the first sweep, and whenever one of its bodies has changed since.
bool ImpactPhase::is_to_solve(const Pair& p, Stage stage, int sweep) {
  if (!p.collides || (stage == Stage::tangential && contacts_[p.first].friction <= 0)) return false;
  return sweep == 1 || (!p.alone && (shared(bodies_[p.a], word) != 0 || shared(bodies_[p.b], word) != 0));
}

/// Returns whether a pair has changed. The bodies of those that have tell their partners.
bool ImpactPhase::sweep(Stage stage, int sweep) {
  bool moving = false;
  for (Body& b : bodies_) b.changed = false;
  for (const Pair& p : pairs_) {
    if (!is_to_solve(p, stage, sweep)) continue;
    const bool changed = solve(p, stage) > sweep_tolerance && !p.alone;
    for (const std::size_t end : {p.a, p.b}) bodies_[end].changed = bodies_[end].changed || changed;
    moving = moving || changed;
    take_impulses(p, old_);
  }
  apply();
  for (const Body& b : bodies_) shared(b, word) = b.moves && b.changed;
  return moving;
}

/// Makes at least one sweep, at most most_sweeps_: then they are cut short, and bodies that have not come to
/// rest tell by their word. Returns how many.
int ImpactPhase::sweep_to_rest(BodySet& bodies, BodyExchange& exchange, Stage stage) {
  CommonRest rest(exchange);
  for (int i = 1;; ++i) {
    const bool at_rest = rest.reached(sweep(stage, i));
    rest.share(bodies, state_, share_width);
    cut_short_ = !at_rest;
    if (at_rest || i >= most_sweeps_) return i;
  }
}

/// Spreads the word of one body of a cluster of colliding ones until all of them have heard it.
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

/// The plastic impulses times 1 + e, from the velocities at the start of the round; as they are in a cluster
/// some of whose pairs have not come to rest.
void ImpactPhase::rebound(BodySet& bodies, BodyExchange& exchange) {
  if (cut_short_) spread_word(bodies, exchange);
  for (const Body& b : bodies_)
    if (b.moves) write(state_, b.row, b.start);
  for (const Pair& p : pairs_) {
    if (!p.collides) continue;
    const bool settled = shared(bodies_[p.a], word) == 0 && shared(bodies_[p.b], word) == 0;
    for (std::size_t k = p.first; k < p.last; ++k)
      contacts_[k].impulse[0] *= settled ? 1 + p.restitution : 1.0;
    take_impulses(p, {});
  }
  apply();
  exchange.share(bodies, state_, share_width);
}

/// The impulses of a round that has ended.
void ImpactPhase::add_given() {
  for (const Pair& p : pairs_)
    for (std::size_t k = p.first; k < p.last && p.collides; ++k)
      for (int d = 0; d < 3; ++d) contacts_[k].given += contacts_[k].impulse[d] * contacts_[k].direction[d];
}

/// What impacts gave, and how fast they parted the contacts that they gave it to.
void ImpactPhase::note_impacts(const BodySet& bodies, std::size_t contacts,
                               StepVelocities& velocities) const {
  const auto was_hit = [](const ImpactContact& c) { return !c.given.isZero(0); };
  velocities.rebounds.clear();
  if (std::ranges::none_of(contacts_, was_hit)) return;
  velocities.rebounds.assign(contacts, std::numeric_limits<double>::lowest());
  for (const Pair& p : pairs_) {
    const Body &a = bodies_[p.a], &b = bodies_[p.b];
    const Twist twist_a = read(state_, a.row), twist_b = read(state_, b.row);
    const bool tells = velocities.tells_impulses(bodies, a.row, b.row);
    for (std::size_t k = p.first; k < p.last; ++k) {
      const ImpactContact& c = contacts_[k];
      if (!was_hit(c)) continue;
      velocities.rebounds[c.index] = c.direction[0].dot(twist_b.at(c.r_b) - twist_a.at(c.r_a));
      if (tells) velocities.other_impulses.push_back({c.index, c.given, Vec3::Zero()});
    }
  }
}

bool ImpactPhase::rubs() const {
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
    if (on_any(bodies, exchange, rubs())) sweeps += sweep_to_rest(bodies, exchange, Stage::tangential);
    add_given();
  }
  note_impacts(bodies, contacts.size(), velocities);
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
