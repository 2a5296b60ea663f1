#include "rigid/response/impact_phase.hpp"

#include <algorithm>
#include <cmath>

namespace silt::rigid {

namespace {

constexpr int width = 7;                     // doubles a body in a share: v, w, number of pairs
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
};

}  // namespace

std::size_t ImpactPhase::involve(const BodySet& bodies, std::size_t row) {
  if (index_[row] < 0) {
    index_[row] = static_cast<std::int32_t>(bodies_.size());
    bodies_.push_back({.row = row,
                       .moves = row < bodies.owned && bodies.is_free(row),
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
  for (std::size_t first = 0, last; first < contacts.size(); first = last) {
    const Contact& c = contacts[first];
    for (last = first + 1; last < contacts.size() && contacts[last].pair() == c.pair();) ++last;
    if (c.restitution <= 0) continue;
    const std::size_t a = involve(bodies, bodies.row_of(c.a)), b = involve(bodies, bodies.row_of(c.b));
    if (!bodies_[a].moves && !bodies_[b].moves) continue;  // its owners' business
    // of a wall only its turning matters, and few turn
    const bool b_turns = !is_wall(c.b) || bodies.angular_velocity[bodies_[b].row] != Vec3::Zero();
    const std::size_t from = contacts_.size();
    for (std::size_t k = first; k < last; ++k)
      contacts_.push_back({.direction = contact_directions(contacts[k].normal),
                           .r_a = contacts[k].r_a,
                           .r_b = b_turns ? contacts[k].r_b : Vec3(Vec3::Zero()),
                           .gap = contacts[k].gap,
                           .friction = contacts[k].friction});
    pairs_.push_back({.first = from, .last = contacts_.size(), .a = a, .b = b, .restitution = c.restitution});
  }
}

namespace {

Twist read(const std::vector<double>& state, std::size_t row) {
  const double* s = state.data() + row * width;
  return {{s[0], s[1], s[2]}, {s[3], s[4], s[5]}};
}

void write(std::vector<double>& state, std::size_t row, const Twist& t) {
  double* s = state.data() + row * width;
  for (int d = 0; d < 3; ++d) {
    s[d] = t.v[d];
    s[3 + d] = t.w[d];
  }
}

}  // namespace

/// Marks the contacts that approach and touch, or would within the step. 0: none.
double ImpactPhase::largest_approaching_restitution(double dt) {
  double largest = 0;
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
    if (p.collides) largest = std::max(largest, p.restitution);
  }
  return largest;
}

/// Picks the round's pairs, counts them at their bodies and splits the masses accordingly.
void ImpactPhase::begin_round(BodySet& bodies, BodyExchange& exchange, double restitution) {
  for (Body& b : bodies_) {
    b.pairs = 0;
    b.start = read(state_, b.row);
  }
  for (Pair& p : pairs_) {
    p.collides = p.collides && p.restitution == restitution;
    if (!p.collides) continue;
    ++bodies_[p.a].pairs;
    ++bodies_[p.b].pairs;
  }
  for (const Body& b : bodies_) state_[b.row * width + 6] = b.pairs;
  exchange.share(bodies, state_, width);
  for (Pair& p : pairs_)
    if (p.collides) split_masses(p);
}

void ImpactPhase::split_masses(Pair& p) {
  const Body &a = bodies_[p.a], &b = bodies_[p.b];
  const double n_a = state_[a.row * width + 6], n_b = state_[b.row * width + 6];
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
    c.k_t = 0.5 * (k11 + k22) + std::hypot(0.5 * (k11 - k22), k12);
    c.impulse = {};
  }
}

/// Solves one pair from the common velocities. Returns how much its impulses changed, relative to the
/// largest.
double ImpactPhase::solve(const Pair& p, Stage stage) {
  const Body &body_a = bodies_[p.a], &body_b = bodies_[p.b];
  const double n_a = state_[body_a.row * width + 6], n_b = state_[body_b.row * width + 6];
  Sides sides{read(state_, body_a.row),  read(state_, body_b.row),     n_a * body_a.inverse_mass,
              n_b * body_b.inverse_mass, n_a * body_a.inverse_inertia, n_b * body_b.inverse_inertia};
  old_.clear();
  for (std::size_t k = p.first; k < p.last; ++k) old_.push_back(contacts_[k].impulse);
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
        const double size = std::hypot(impulse[1], impulse[2]), limit = c.friction * impulse[0];
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
    if (change <= round_tolerance * scale) break;
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
    if (b.moves && b.pairs > 0) {
      Twist t = read(state_, b.row);
      t.v += b.inverse_mass * b.impulse;
      t.w += b.inverse_inertia * b.angular_impulse;
      write(state_, b.row, t);
    }
    b.impulse = b.angular_impulse = Vec3::Zero();
  }
}

double ImpactPhase::sweep(Stage stage) {
  double residual = 0;
  for (const Pair& p : pairs_) {
    if (!p.collides) continue;
    const double change = solve(p, stage);
    if (!p.alone) residual = std::max(residual, change);
    take_impulses(p, old_);
  }
  apply();
  return residual;
}

/// At least one sweep, at most `most`. Returns how many.
int ImpactPhase::sweep_to_rest(BodySet& bodies, BodyExchange& exchange, Stage stage, int most,
                               bool& converged) {
  for (int i = 1;; ++i) {
    converged = exchange.maximum(sweep(stage)) <= sweep_tolerance;
    exchange.share(bodies, state_, width);
    if (converged || i >= most) return i;
  }
}

/// The plastic impulses times the factor, from the velocities at the start of the round.
void ImpactPhase::rebound(BodySet& bodies, BodyExchange& exchange, double factor) {
  for (const Body& b : bodies_)
    if (b.moves) write(state_, b.row, b.start);
  for (const Pair& p : pairs_) {
    if (!p.collides) continue;
    for (std::size_t k = p.first; k < p.last; ++k) contacts_[k].impulse[0] *= factor;
    take_impulses(p, {});
  }
  apply();
  exchange.share(bodies, state_, width);
}

bool ImpactPhase::rubs() const {
  return std::any_of(pairs_.begin(), pairs_.end(),
                     [&](const Pair& p) { return p.collides && contacts_[p.first].friction > 0; });
}

int ImpactPhase::operator()(BodySet& bodies, const std::vector<Contact>& contacts, double dt,
                            StepVelocities& velocities, BodyExchange& exchange) {
  collect(bodies, contacts);
  state_.assign(bodies.size() * width, 0.0);
  for (const Body& b : bodies_)
    write(state_, b.row, {velocities.before_v[b.row], velocities.before_w[b.row]});
  int sweeps = 0;
  while (sweeps < most_sweeps_) {
    const double restitution = exchange.maximum(largest_approaching_restitution(dt));
    if (restitution == 0) break;
    begin_round(bodies, exchange, restitution);
    bool converged = false;
    sweeps += sweep_to_rest(bodies, exchange, Stage::normal, most_sweeps_ - sweeps, converged);
    rebound(bodies, exchange, converged ? 1 + restitution : 1.0);
    if (exchange.maximum(rubs() ? 1.0 : 0.0) > 0)
      sweeps += sweep_to_rest(bodies, exchange, Stage::tangential, most_sweeps_ - sweeps, converged);
  }
  for (const Body& b : bodies_) {
    const Twist now = read(state_, b.row);
    Vec3 &v = velocities.before_v[b.row], &w = velocities.before_w[b.row];
    if (b.moves && now.v != v) velocities.v[b.row] += now.v - v;
    if (b.moves && now.w != w) velocities.w[b.row] += now.w - w;
    v = now.v;
    w = now.w;
  }
  return sweeps;
}

ResolverStatistics ImpactThenContact::resolve(BodySet& bodies, const std::vector<Contact>& contacts,
                                              double dt, StepVelocities& velocities, BodyExchange& exchange) {
  const int sweeps = impact_(bodies, contacts, dt, velocities, exchange);
  plastic_ = contacts;
  for (Contact& c : plastic_) c.restitution = 0;
  ResolverStatistics statistics = contact_->resolve(bodies, plastic_, dt, velocities, exchange);
  statistics.impact_sweeps = sweeps;
  return statistics;
}

}  // namespace silt::rigid
