#include "coupler/forces/coupling_in_time.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>

#include "coupler/exchange/coupling_state.hpp"
#include "lbm/walls/cut_links.hpp"

namespace silt::coupler {

using rigid::Mat3;
using rigid::Vec3;

namespace {

/// Half of the eigenvalue up to which one pass is stable, alone and in dense beds
/// (scripts/accuracy/coupling_in_time.md).
double one_pass_limit(double relaxation_time) {
  const double relaxation = relaxation_time - 0.5;
  return std::min({4 * relaxation, 1.0, 0.8 / relaxation});
}

/// Half of the eigenvalue up to which the explicit step is stable, 0.40 sqrt(tau - 1/2) within a fifth.
/// `exact` uses it as its one-pass scheme, since deferred impulses would violate the exact sum of momenta.
double explicit_limit(double relaxation_time) {
  return 0.20 * std::sqrt(relaxation_time - 0.5);
}

Vec6 force_of(const std::int64_t* row) {
  Vec6 f;
  for (int d = 0; d < 6; ++d) f[d] = double(row[d]) * lbm::link_quantum;
  return f;
}

Mat6 resistance_of(const std::int64_t* entry, double quantum, int exponent) {
  const double quanta[3] = {quantum, std::ldexp(quantum, exponent), std::ldexp(quantum, 2 * exponent)};
  Mat6 h;
  for (int r = 0; r < 6; ++r)
    for (int c = r; c < 6; ++c) h(r, c) = h(c, r) = double(*entry++) * quanta[(r >= 3) + (c >= 3)];
  return h;
}

Mat6 mass_matrix(const rigid::BodySet& bodies, std::size_t row) {
  Mat6 m = Mat6::Zero();
  m.topLeftCorner<3, 3>() = bodies.mass[row] * Mat3::Identity();
  Mat3 inertia = bodies.inertia_B[row];
  if (!bodies.is_isotropic(row)) {
    const Mat3 r = bodies.orientation[row].toRotationMatrix();
    inertia = r * inertia * r.transpose();
  }
  m.bottomRightCorner<3, 3>() = inertia;
  constexpr double as_good_as_infinite = 1e30;
  for (int i = 0; i < 6; ++i)
    if (bodies.locked(row) >> i & 1) m(i, i) *= as_good_as_infinite;
  return m;
}

/// Solves m x = b for symmetric positive definite m, by elimination of the 3 x 3 block of velocities.
Vec6 solution_of(const Mat6& m, const Vec6& b) {
  const Mat3 mixed = m.topRightCorner<3, 3>(), inverse = Mat3(m.topLeftCorner<3, 3>()).inverse();
  const Mat3 taken = inverse * mixed;
  const Vec3 v = inverse * b.head<3>();
  Vec6 x;
  x.tail<3>() = Mat3(m.bottomRightCorner<3, 3>() - mixed.transpose() * taken).inverse() *
                (b.tail<3>() - mixed.transpose() * v);
  x.head<3>() = v - taken * x.tail<3>();
  return x;
}

/// Returns the part of the last step's load that continues: what opposes the new load, up to `most` times it.
Vec3 going_on(const Vec3& last, const Vec3& load, double most) {
  const double opposing = -last.dot(load);
  if (!(opposing > 0)) return Vec3::Zero();
  return std::min(opposing / last.squaredNorm(), most) * last;
}

/// The loads of contacts and films on a body in the last step.
struct LastStep {
  Vec3 contacts = Vec3::Zero(), films = Vec3::Zero();  // impulses of a sub-step
  Vec3 approach = Vec3::Zero();  // of films: relative momentum to the other bodies, times the impulse
  double weight = 0, mass = 0;   // of films: sum of impulses, and of impulses times reduced mass
  Vec3 rolling, torque;          // against rolling, which is not stored; of contacts and films
  bool still_held;               // by some contact, and no film's other body has left

  LastStep(const rigid::BodySet& bodies, std::size_t row, int substeps)
      : rolling(coupling_of(bodies, row).contact_load.linear()),
        torque(coupling_of(bodies, row).contact_load.angular()),
        still_held(!bodies.stored_impulses[row].empty()) {
    for (const auto& s : bodies.stored_impulses[row]) {
      const Vec3 impulse = s.partner < bodies.id[row] ? s.impulse : Vec3(-s.impulse);
      rolling -= substeps * impulse;
      if (s.feature & rigid::lubrication_feature)
        add_film(bodies, row, s, impulse);
      else
        contacts += impulse;
    }
  }
  void add_film(const rigid::BodySet& bodies, std::size_t row, const rigid::StoredImpulse& s,
                const Vec3& impulse) {
    const std::size_t other = bodies.row_of(s.partner);
    still_held &= other < bodies.size();
    if (other >= bodies.size()) return;
    const double size = s.impulse.norm();
    const double reduced_mass = 1 / (bodies.inverse_mass(row) + bodies.inverse_mass(other));
    films += impulse;
    approach += size * reduced_mass * (bodies.velocity[row] - bodies.velocity[other]);
    weight += size, mass += size * reduced_mass;
  }
  /// Returns the films' expected impulse in the coming step. A film that gave an impulse in the last sub-step
  /// gives it again in each sub-step while the load lasts. Films damp: at most they balance the load and stop
  /// the motion relative to the other bodies, but reverse neither. After an impact, which a film may have met
  /// within a single sub-step, the film gives nothing.
  Vec3 films_going_on(const Vec3& load, double turning_speed, double radius, int substeps) const {
    const double size = films.norm();
    if (size == 0) return Vec3::Zero();
    const double turning = mass * turning_speed * radius;
    const double opposing = (turning - approach.dot(films) / size) / weight - load.dot(films) / size;
    return std::clamp(opposing / size, 0.0, double(substeps)) * films;
  }
};

void add_force(rigid::BodySet& bodies, std::size_t row, const Vec6& f) {
  bodies.add_force(row, f.head<3>());
  bodies.add_torque(row, f.tail<3>());
}

/// Returns a lower bound of the principal moments (Gershgorin), which may be useless (<= 0).
double least_moment(const Mat3& inertia) {
  const Mat3 sizes = inertia.cwiseAbs();
  return (2 * sizes.diagonal() - sizes.rowwise().sum()).minCoeff();
}

}  // namespace

bool largest_eigenvalue_is_within(double limit, const Mat6& resistance, double mass, const Mat3& inertia_B) {
  if (resistance(0, 0) > limit * mass) return false;  // early exit for light bodies
  const double moment = least_moment(inertia_B);
  if (!(moment > 0)) return false;
  Vec6 scale;
  scale << Vec3::Constant(1 / std::sqrt(mass)), Vec3::Constant(1 / std::sqrt(moment));
  return scale.cwiseProduct(resistance.cwiseAbs() * scale).maxCoeff() <= limit;
}

void add_link_force(rigid::BodySet& bodies, std::size_t row, const RowSums& sums) {
  add_force(bodies, row, force_of(sums.force(row)));
}

CouplingInTime::CouplingInTime(const rigid::World& world, const CouplingSpec& spec, int substeps,
                               double relaxation_time, double resistance_quantum)
    : world_(world),
      substeps_(substeps),
      of_stiff_links_(spec.time == TimeCoupling::implicit_ ? TimeScheme::implicit_ : TimeScheme::explicit_),
      of_soft_links_(spec.force == ForceForm::exact ? TimeScheme::explicit_ : TimeScheme::one_pass),
      soft_limit_(spec.force == ForceForm::exact ? explicit_limit(relaxation_time)
                                                 : one_pass_limit(relaxation_time)),
      resistance_quantum_(resistance_quantum) {}

/// Returns F + F_ext.
Vec6 CouplingInTime::load_on(const rigid::BodySet& bodies, std::size_t row, const Vec6& link_force) const {
  Vec6 external;
  external << bodies.force[row].value() + bodies.mass[row] * bodies.weight_in_fluid[row] * world_.gravity,
      bodies.torque[row].value();
  Vec6 load = link_force + external;
  const LastStep last(bodies, row, substeps_);
  load.head<3>() += last.films_going_on(load.head<3>(), bodies.angular_velocity[row].norm(),
                                        world_.bounding_radii[bodies.shape[row]], substeps_);
  // A body that rests or rolls continues to; an impact is not repeated.
  if (last.still_held) load.head<3>() += going_on(last.rolling, load.head<3>(), 1);
  load.head<3>() += going_on(last.contacts, load.head<3>(), substeps_);
  if (last.still_held) load.tail<3>() += going_on(last.torque, load.tail<3>(), 1);
  return load;
}

/// Solves (M + H) delta = load + left, adds F + left - H delta to the row's load, and returns delta.
Vec6 CouplingInTime::solve(rigid::BodySet& bodies, std::size_t row, const Links& links, const Vec6& load,
                           const Vec6& left) const {
  const Vec6 delta = solution_of(mass_matrix(bodies, row) + links.resistance, load + left);
  add_force(bodies, row, links.force + left - links.resistance * delta);
  return delta;
}

Vec6 CouplingInTime::apply_explicitly(rigid::BodySet& bodies, std::size_t row, const Vec6& force) const {
  coupling_of(bodies, row).foreseen_change = {};
  add_force(bodies, row, force);
  return Vec6::Zero();
}

Vec6 CouplingInTime::apply_implicitly(rigid::BodySet& bodies, std::size_t row, const Links& links) const {
  Eigen::Map<Vec6> foreseen = coupling_of(bodies, row).foreseen_change();
  const Vec6 load = load_on(bodies, row, links.force);
  const Vec6 correction = solve(bodies, row, links, load, links.resistance * foreseen) - foreseen;
  foreseen.setZero();
  coupling_of(bodies, row).deferred_impulse() = load / 2;
  return correction;
}

Vec6 CouplingInTime::apply_in_one_pass(rigid::BodySet& bodies, std::size_t row, const Links& links) const {
  CouplingState& state = coupling_of(bodies, row);
  Eigen::Map<Vec6> foreseen = state.foreseen_change(), deferred = state.deferred_impulse();
  const Vec6 load = load_on(bodies, row, links.force);
  foreseen = solve(bodies, row, links, load, deferred - load / 2);
  deferred = load / 2 + links.resistance * foreseen;
  return Vec6::Zero();
}

Vec6 CouplingInTime::apply_links(rigid::BodySet& bodies, std::size_t row, const RowSums& sums) const {
  Links links;
  links.force = force_of(sums.force(row));
  if (!is_implicit()) return apply_explicitly(bodies, row, links.force);
  const int exponent = lbm::resistance_exponent(world_.bounding_radii[bodies.shape[row]]);
  links.resistance = resistance_of(sums.resistance(row), resistance_quantum_, exponent);
  const bool soft =
      largest_eigenvalue_is_within(soft_limit_, links.resistance, bodies.mass[row], bodies.inertia_B[row]);
  switch (soft ? of_soft_links_ : of_stiff_links_) {
    case TimeScheme::explicit_:
      return apply_explicitly(bodies, row, links.force);
    case TimeScheme::implicit_:
      return apply_implicitly(bodies, row, links);
    case TimeScheme::one_pass:
      return apply_in_one_pass(bodies, row, links);
  }
  return Vec6::Zero();
}

}  // namespace silt::coupler
