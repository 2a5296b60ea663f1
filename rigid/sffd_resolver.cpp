#include "rigid/sffd_resolver.hpp"

#include <algorithm>
#include <cmath>

#include "rigid/warm_start.hpp"

namespace silt::rigid {

namespace {

constexpr int width = 7;           // doubles a body in a share: v, w, number
constexpr double rounding = 1e-5;  // times mass x speed: an impulse this small says nothing about convergence
constexpr double push_tolerance = 1e-3;      // of the position correction's impulses, relative
constexpr double push_rounding = 1e-7;       // displacement of a step, relative to the contact's lever arms
constexpr double negligible_overlap = 1e-9;  // relative to the contact's lever arms: left alone

Twist twist(const std::vector<double>& state, std::size_t row) {
  const double* s = state.data() + row * width;
  return {{s[0], s[1], s[2]}, {s[3], s[4], s[5]}};
}

void store(std::vector<double>& state, std::size_t row, const Twist& t, double number) {
  double* s = state.data() + row * width;
  for (int d = 0; d < 3; ++d) s[d] = t.v[d], s[3 + d] = t.w[d];
  s[6] = number;
}

/// Least normal velocity after the step (FFD.md 5.2): what closes the gap, or what Newton's restitution asks
/// of a contact that would be reached, from the velocities before the kick (so that a body at rest does not
/// bounce).
double target_velocity(const Contact& c, double dt, const Vec3& before) {
  const double closing = c.gap > 0 ? -c.gap / dt : 0.0, speed = c.normal.dot(before);
  const bool hits = speed < 0 && (c.gap <= 0 || c.gap + dt * speed < 0);
  return hits ? std::max(closing, -c.restitution * speed) : closing;
}

double lever_arms(const Contact& c) {
  return is_wall(c.b) ? c.r_a.norm() : c.r_a.norm() + c.r_b.norm();
}

}  // namespace

std::size_t SffdResolver::involve(const BodySet& bodies, std::size_t row) {
  if (index_[row] < 0) {
    index_[row] = static_cast<std::int32_t>(bodies_.size());
    const bool moves = row < bodies.owned && bodies.is_free(row);
    bodies_.push_back({row, moves, bodies.inverse_mass(row), bodies.inverse_inertia_W(row)});
  }
  return static_cast<std::size_t>(index_[row]);
}

void SffdResolver::collect_pairs(const BodySet& bodies, const std::vector<Contact>& contacts) {
  bodies_.clear();
  pairs_.clear();
  index_.assign(bodies.size(), -1);
  for (std::size_t first = 0, last; first < contacts.size(); first = last) {
    const Contact& c = contacts[first];
    for (last = first + 1; last < contacts.size() && contacts[last].pair() == c.pair();) ++last;
    const std::size_t a = involve(bodies, bodies.row_of(c.a)), b = involve(bodies, bodies.row_of(c.b));
    if (!bodies_[a].moves && !bodies_[b].moves) continue;  // its owners' business
    ++bodies_[a].pairs;
    ++bodies_[b].pairs;
    pairs_.push_back({first, last, a, b});
  }
}

void SffdResolver::start(const BodySet& bodies, const std::vector<Contact>& contacts, double dt,
                         const StepVelocities& velocities) {
  rows_.clear();
  rows_.reserve(contacts.size());
  for (const Contact& c : contacts) {
    ContactRow row;
    row.direction = contact_directions(c.normal), row.r_a = c.r_a, row.r_b = c.r_b;
    row.friction = c.friction;
    const std::size_t a = bodies.row_of(c.a), b = bodies.row_of(c.b);
    row.target = target_velocity(c, dt,
                                 Twist{velocities.before_v[b], velocities.before_w[b]}.at(c.r_b) -
                                     Twist{velocities.before_v[a], velocities.before_w[a]}.at(c.r_a));
    rows_.push_back(row);
  }
  state_.resize(bodies.size() * width);
  for (const Body& b : bodies_) store(state_, b.row, {velocities.v[b.row], velocities.w[b.row]}, b.pairs);
  if (settings_.warm_start) warm_start(bodies, contacts);
}

void SffdResolver::warm_start(const BodySet& bodies, const std::vector<Contact>& contacts) {
  for (Body& b : bodies_) b.impulse = b.angular_impulse = Vec3::Zero();
  for (const Pair& p : pairs_) {
    const bool at_a = bodies_[p.a].moves;
    const Contact& c = contacts[p.first];
    const std::span rows(rows_.data() + p.first, p.last - p.first);
    recall_impulses(bodies.stored_impulses[bodies_[at_a ? p.a : p.b].row], at_a ? c.b : c.a,
                    {contacts.data() + p.first, rows.size()}, rows);
    for (const ContactRow& row : rows) {
      const Vec3 impulse = row.impulse_W();
      bodies_[p.a].impulse -= impulse;
      bodies_[p.a].angular_impulse -= row.r_a.cross(impulse);
      bodies_[p.b].impulse += impulse;
      bodies_[p.b].angular_impulse += row.r_b.cross(impulse);
    }
  }
  for (const Body& b : bodies_) {
    if (!b.moves) continue;
    Twist t = twist(state_, b.row);
    t.v += b.inverse_mass * b.impulse;
    t.w += b.inverse_inertia * b.angular_impulse;
    store(state_, b.row, t, b.pairs);
  }
}

void SffdResolver::split_masses(const BodySet& bodies) {
  std::size_t needed = 0;
  for (Pair& p : pairs_) {
    p.matrix = needed;
    needed += matrix_size(p.last - p.first);
  }
  matrices_.resize(needed);
  for (Pair& p : pairs_) {
    const Body &a = bodies_[p.a], &b = bodies_[p.b];
    const double n_a = state_[a.row * width + 6], n_b = state_[b.row * width + 6];
    p.single = set_effective_masses(
        {rows_.data() + p.first, p.last - p.first}, {n_a * a.inverse_mass, n_a * a.inverse_inertia},
        {n_b * b.inverse_mass, n_b * b.inverse_inertia}, matrices_.data() + p.matrix);
    p.final_after_one = (n_a == 1 || !bodies.is_free(a.row)) && (n_b == 1 || !bodies.is_free(b.row));
    p.reduced_mass = 1 / (a.inverse_mass + b.inverse_mass);
  }
}

void SffdResolver::set_least_scales(const BodySet& bodies, double dt, bool push) {
  for (Pair& p : pairs_) {
    const std::size_t a = bodies_[p.a].row, b = bodies_[p.b].row;
    const double arms = rows_[p.first].r_a.norm() + (is_wall(bodies.id[b]) ? 0.0 : rows_[p.first].r_b.norm());
    const Twist t_a = twist(state_, a), t_b = twist(state_, b);
    const double speed = std::max({t_a.v.norm(), t_b.v.norm(), arms * t_a.w.norm(), arms * t_b.w.norm()});
    p.least_scale = p.reduced_mass * (push ? push_rounding * arms / dt : rounding * speed);
  }
}

double SffdResolver::sweep(std::vector<double>& state, double tolerance, bool first, bool push) {
  double residual = 0;
  for (Body& b : bodies_) {
    b.impulse = b.angular_impulse = Vec3::Zero();
    b.changed = false;
  }
  for (const Pair& p : pairs_) {
    Body &a = bodies_[p.a], &b = bodies_[p.b];
    const bool woken = (a.inverse_mass > 0 && state[a.row * width + 6] != 0) ||
                       (b.inverse_mass > 0 && state[b.row * width + 6] != 0);
    if (!first && (p.final_after_one || !woken)) continue;
    const PairLaw law = p.single ? PairLaw::single : push ? PairLaw::frictionless : PairLaw::coulomb;
    const PairChange change =
        solve_pair({rows_.data() + p.first, p.last - p.first}, matrices_.data() + p.matrix,
                   twist(state, a.row), twist(state, b.row), law);
    a.impulse -= change.impulse;
    a.angular_impulse -= change.angular_a;
    b.impulse += change.impulse;
    b.angular_impulse += change.angular_b;
    if (change.largest == 0) continue;
    const double relative = change.largest / std::max(change.scale, p.least_scale);
    if (relative > tolerance) a.changed = b.changed = true;
    if (!p.final_after_one) residual = std::max(residual, relative);
  }
  return residual;
}

void SffdResolver::apply_impulses(std::vector<double>& state) {
  for (const Body& b : bodies_) {
    if (!b.moves) continue;
    Twist t = twist(state, b.row);
    if (b.impulse != Vec3::Zero() || b.angular_impulse != Vec3::Zero()) {
      t.v += b.inverse_mass * b.impulse;
      t.w += b.inverse_inertia * b.angular_impulse;
    }
    store(state, b.row, t, b.changed ? 1.0 : 0.0);
  }
}

/// The same number of sweeps, shares and maxima on every rank. Returns the number of sweeps.
int SffdResolver::sweep_to_rest(BodySet& bodies, BodyExchange& exchange, std::vector<double>& state,
                                double tolerance, bool push, double& residual) {
  for (int i = 1;; ++i) {
    residual = exchange.maximum(sweep(state, tolerance, i == 1, push));
    apply_impulses(state);
    if (residual <= tolerance || i >= settings_.max_sweeps) return i;
    exchange.share(bodies, state, width);
  }
}

/// The deepest overlap that a correction is worth, of the pairs solved here; 0: none.
double SffdResolver::correctable_overlap(const std::vector<Contact>& contacts) const {
  double deepest = 0;
  for (const Pair& p : pairs_)
    for (std::size_t k = p.first; k < p.last; ++k) {
      const Contact& c = contacts[k];
      if (-c.gap > settings_.slop + negligible_overlap * lever_arms(c)) deepest = std::max(deepest, -c.gap);
    }
  return deepest;
}

/// FFD.md 5.5: b_n >= share of the overlap that the velocity does not take back by itself; an open contact
/// may use up the gap that is left.
void SffdResolver::set_push_targets(const std::vector<Contact>& contacts, double dt) {
  for (const Pair& p : pairs_)
    for (std::size_t k = p.first; k < p.last; ++k) {
      ContactRow& row = rows_[k];
      const Contact& c = contacts[k];
      const double u = row.normal().dot(twist(state_, bodies_[p.b].row).at(row.r_b) -
                                        twist(state_, bodies_[p.a].row).at(row.r_a));
      const double overlap = settings_.correction * (-c.gap - settings_.slop) / dt - std::max(0.0, u);
      row.target = c.gap > 0 ? std::min(0.0, -(c.gap / dt + u)) : std::max(0.0, overlap);
      row.impulse = {};
      row.friction = 0;
    }
}

void SffdResolver::remember(BodySet& bodies, const std::vector<Contact>& contacts) const {
  for (std::size_t row = 0; row < bodies.owned; ++row) bodies.stored_impulses[row].clear();
  if (!settings_.warm_start) return;
  // in key order, so each body's list comes out sorted by partner, image, feature
  for (const Pair& p : pairs_) {
    const std::span of_pair(contacts.data() + p.first, p.last - p.first);
    const std::span rows(rows_.data() + p.first, of_pair.size());
    if (bodies_[p.a].moves)
      remember_impulses(of_pair, rows, of_pair[0].b, bodies.stored_impulses[bodies_[p.a].row]);
    if (bodies_[p.b].moves)
      remember_impulses(of_pair, rows, of_pair[0].a, bodies.stored_impulses[bodies_[p.b].row]);
  }
}

void SffdResolver::count(const BodySet& bodies, const std::vector<Contact>& contacts,
                         ResolverStatistics& statistics) const {
  for (const Contact& c : contacts) {
    if (bodies.row_of(c.a) < bodies.owned) ++statistics.contacts;
    statistics.penetration = std::max(statistics.penetration, -c.gap);
  }
  for (const ContactRow& row : rows_)
    if (row.impulse[0] > 0)
      statistics.cone_excess =
          std::max(statistics.cone_excess, row.tangential_impulse() / row.impulse[0] - row.friction);
}

/// Split impulses: the same sweeps, frictionless, for velocities that move bodies apart and are then
/// forgotten.
void SffdResolver::correct_positions(BodySet& bodies, const std::vector<Contact>& contacts, double dt,
                                     StepVelocities& velocities, BodyExchange& exchange) {
  exchange.share(bodies, state_, width);
  set_push_targets(contacts, dt);
  set_least_scales(bodies, dt, true);
  push_.resize(bodies.size() * width);
  for (const Body& b : bodies_) store(push_, b.row, Twist{}, 0);
  double residual = 0;
  sweep_to_rest(bodies, exchange, push_, push_tolerance, true, residual);
  velocities.push_v.assign(bodies.size(), Vec3::Zero());
  velocities.push_w.assign(bodies.size(), Vec3::Zero());
  for (const Body& b : bodies_) {
    if (!b.moves) continue;
    const Twist t = twist(push_, b.row);
    velocities.push_v[b.row] = t.v;
    velocities.push_w[b.row] = t.w;
  }
}

ResolverStatistics SffdResolver::resolve(BodySet& bodies, const std::vector<Contact>& contacts, double dt,
                                         StepVelocities& velocities, BodyExchange& exchange) {
  ResolverStatistics statistics;
  velocities.push_v.clear();
  velocities.push_w.clear();
  pairs_.clear();
  if (exchange.maximum(contacts.empty() ? 0.0 : 1.0) == 0) {
    remember(bodies, contacts);
    return statistics;
  }
  collect_pairs(bodies, contacts);
  start(bodies, contacts, dt, velocities);
  exchange.share(bodies, state_, width);
  split_masses(bodies);
  set_least_scales(bodies, dt, false);
  statistics.sweeps =
      sweep_to_rest(bodies, exchange, state_, settings_.sweep_tolerance, false, statistics.residual);
  remember(bodies, contacts);
  count(bodies, contacts, statistics);
  for (const Body& b : bodies_) {
    if (!b.moves) continue;
    const Twist t = twist(state_, b.row);
    velocities.v[b.row] = t.v;
    velocities.w[b.row] = t.w;
  }
  if (settings_.correction > 0 && exchange.maximum(correctable_overlap(contacts)) > 0)
    correct_positions(bodies, contacts, dt, velocities, exchange);
  return statistics;
}

}  // namespace silt::rigid
