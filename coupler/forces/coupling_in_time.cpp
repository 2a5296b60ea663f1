#include "coupler/forces/coupling_in_time.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>

#include "coupler/exchange/coupling_state.hpp"
#include "coupler/forces/eigenvalue_bound.hpp"
#include "lbm/cut_links.hpp"

namespace silt::coupler {

using rigid::Mat3;
using rigid::Vec3;
using Mat6 = Eigen::Matrix<double, 6, 6>;

namespace {

/// One pass is stable up to twice this eigenvalue at least, alone and in dense beds
/// (scripts/accuracy/coupling_in_time.md).
double deferring_limit(double relaxation_time) {
  const double relaxation = relaxation_time - 0.5;
  return std::min({4 * relaxation, 1.0, 0.8 / relaxation});
}

/// The explicit step is stable up to an eigenvalue of 0.40 sqrt(tau - 1/2), within a fifth. It is the one
/// pass of `exact`, which cannot keep the sum of all momenta to the bit with impulses under way.
double explicit_limit(double relaxation_time) {
  return 0.20 * std::sqrt(relaxation_time - 0.5);
}

Vec6 force_of(const std::int64_t* row) {
  Vec6 f;
  for (int d = 0; d < 6; ++d) f[d] = double(row[d]) * lbm::link_quantum;
  return f;
}

Mat6 stiffness_of(const std::int64_t* entry, double quantum, int exponent) {
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
  return m;
}

/// x with m x = b, m symmetric and positive definite: its blocks of velocity and of rotation are eliminated
/// one after the other.
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

/// What contacts without a film will hold of a load: what they held in the last step, as far as it opposes
/// the load. A body that rests stays where it is; one that was struck is not struck again.
Vec3 held_by_contacts(const rigid::BodySet& bodies, std::size_t row, int substeps, const Vec3& load) {
  Vec3 contacts = Vec3::Zero();  // impulses of a sub-step
  for (const auto& s : bodies.stored_impulses[row])
    if (!(s.feature & rigid::lubrication_feature))
      contacts += s.partner < bodies.id[row] ? s.impulse : Vec3(-s.impulse);
  const double opposing = -contacts.dot(load), square = contacts.squaredNorm();
  if (!(opposing > 0)) return Vec3::Zero();
  return std::min(opposing / square, double(substeps)) * contacts;
}

/// Films of a body that has left the scene are gone.
bool is_gone(const rigid::BodySet& bodies, const rigid::StoredImpulse& s) {
  return (s.feature & rigid::lubrication_feature) && bodies.row_of(s.partner) >= bodies.size();
}

/// Whether something holds the body as in the last step.
bool is_held_as_before(const rigid::BodySet& bodies, std::size_t row) {
  const auto& stored = bodies.stored_impulses[row];
  return !stored.empty() &&
         std::none_of(stored.begin(), stored.end(), [&](const auto& s) { return is_gone(bodies, s); });
}

/// What of the last step's opposes the load, at most all of it.
Vec3 opposing_part(const Vec3& last, const Vec3& load) {
  const double opposing = -last.dot(load), square = last.squaredNorm();
  if (!(opposing > 0)) return Vec3::Zero();
  return std::min(opposing / square, 1.0) * last;
}

/// The same of what films do against rolling, which no stored impulse has: what contacts and films did
/// in the last step beyond stored impulses.
Vec3 held_against_rolling(const rigid::BodySet& bodies, std::size_t row, int substeps, const Vec3& load) {
  if (!is_held_as_before(bodies, row)) return Vec3::Zero();
  Vec3 rolling = last_contact_force(bodies, row);
  for (const auto& s : bodies.stored_impulses[row])
    rolling -= substeps * (s.partner < bodies.id[row] ? s.impulse : Vec3(-s.impulse));
  return opposing_part(rolling, load);
}

/// The same of a torque, of contacts and films: a body that rests, or rolls, goes on to.
Vec3 turn_held_by_contacts(const rigid::BodySet& bodies, std::size_t row, const Vec3& load) {
  if (!is_held_as_before(bodies, row)) return Vec3::Zero();
  return opposing_part(last_contact_torque(bodies, row), load);
}

/// The impulse of lubrication in the coming step. Films that gave an impulse in the last sub-step give it
/// again in each of the next as long as the load lasts. But films damp: together they hold what presses the
/// body on and stop its motion relative to the bodies beyond them, and turn neither round. So after an
/// impact, which a film may have met within a single sub-step, nothing is left for it to do.
Vec3 impulse_of_films(const rigid::World& world, const rigid::BodySet& bodies, std::size_t row, int substeps,
                      const Vec3& load) {
  Vec3 impulse = Vec3::Zero(), approach = Vec3::Zero();  // of a sub-step; momentum relative to the others
  double weight = 0, mass = 0;
  for (const auto& s : bodies.stored_impulses[row]) {
    if (!(s.feature & rigid::lubrication_feature)) continue;
    const std::size_t other = bodies.row_of(s.partner);
    if (other >= bodies.size()) continue;  // it has left the scene
    const double size = s.impulse.norm();
    const double reduced_mass = 1 / (bodies.inverse_mass(row) + bodies.inverse_mass(other));
    impulse += s.partner < bodies.id[row] ? s.impulse : Vec3(-s.impulse);
    approach += size * reduced_mass * (bodies.velocity[row] - bodies.velocity[other]);
    weight += size, mass += size * reduced_mass;
  }
  const double size = impulse.norm();
  if (size == 0) return Vec3::Zero();
  const double turning = mass * bodies.angular_velocity[row].norm() * world.bounding_radii[bodies.shape[row]];
  const double opposing = (turning - approach.dot(impulse) / size) / weight - load.dot(impulse) / size;
  return std::clamp(opposing / size, 0.0, double(substeps)) * impulse;
}

void add_force(rigid::BodySet& bodies, std::size_t row, const Vec6& f) {
  bodies.add_force(row, f.head<3>());
  bodies.add_torque(row, f.tail<3>());
}

}  // namespace

void add_link_force(rigid::BodySet& bodies, std::size_t row, const RowSums& sums) {
  add_force(bodies, row, force_of(sums.force(row)));
}

ImplicitCoupling::ImplicitCoupling(const rigid::World& world, const CouplingSpec& spec, int substeps,
                                   double relaxation_time, double stiffness_quantum)
    : world_(world),
      substeps_(substeps),
      defers_(spec.force != ForceForm::exact),
      one_pass_limit_(defers_ ? deferring_limit(relaxation_time) : explicit_limit(relaxation_time)),
      stiffness_quantum_(stiffness_quantum) {}

/// F + F_ext.
Vec6 ImplicitCoupling::load_on(const rigid::BodySet& bodies, std::size_t row, const Vec6& link_force) const {
  Vec6 external;
  external << bodies.force[row].value() + bodies.mass[row] * bodies.weight_in_fluid[row] * world_.gravity,
      bodies.torque[row].value();
  Vec6 load = link_force + external;
  load.head<3>() += impulse_of_films(world_, bodies, row, substeps_, load.head<3>());
  load.head<3>() += held_against_rolling(bodies, row, substeps_, load.head<3>());
  load.head<3>() += held_by_contacts(bodies, row, substeps_, load.head<3>());
  load.tail<3>() += turn_held_by_contacts(bodies, row, load.tail<3>());
  return load;
}

Vec6 ImplicitCoupling::take_velocity_change(rigid::BodySet& bodies, std::size_t row,
                                            const RowSums& sums) const {
  const int exponent = lbm::stiffness_exponent(world_.bounding_radii[bodies.shape[row]]);
  const Mat6 h = stiffness_of(sums.stiffness(row), stiffness_quantum_, exponent);
  const Vec6 f = force_of(sums.force(row));
  const bool one_pass =
      largest_eigenvalue_is_within(one_pass_limit_, h, bodies.mass[row], bodies.inertia_B[row]);
  Eigen::Map<Vec6> foreseen = foreseen_change(bodies, row), deferred = deferred_impulse(bodies, row);
  if (one_pass && !defers_) {
    foreseen.setZero();
    add_force(bodies, row, f);
    return Vec6::Zero();
  }
  const Vec6 load = load_on(bodies, row, f);
  const Vec6 left = one_pass ? Vec6(deferred - load / 2) : Vec6(h * foreseen);
  const Vec6 delta = solution_of(mass_matrix(bodies, row) + h, load + left);
  add_force(bodies, row, f + left - h * delta);
  const Vec6 correction = one_pass ? Vec6(Vec6::Zero()) : Vec6(delta - foreseen);
  foreseen = one_pass ? delta : Vec6(Vec6::Zero());
  deferred = load / 2 + h * foreseen;
  return correction;
}

}  // namespace silt::coupler
