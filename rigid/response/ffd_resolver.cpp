#include "rigid/response/ffd_resolver.hpp"

#include <Eigen/QR>
#include <algorithm>
#include <limits>

namespace silt::rigid {
namespace {

constexpr double violation =
    1e-12;  // relative to the constraint's size: smaller violations count as satisfied
constexpr double dependent = 1e-10;     // least part of a unit normal outside the span of the active ones
constexpr int steps_a_constraint = 20;  // limit of steps, against cycling by rounding

class ActiveSet {
 public:
  explicit ActiveSet(std::span<const HalfSpace6> all) : all_(all) {}
  Vec6 y = Vec6::Zero();

  /// Moves until constraint p holds. Returns false if it contradicts the active constraints.
  bool enforce(std::size_t p) {
    double multiplier = 0;
    for (int i = 0; i < steps_a_constraint; ++i) {
      const Vec6& n = all_[p].normal;
      const Eigen::VectorXd r = in_terms_of_active(n);
      Vec6 z = n;
      for (std::size_t k = 0; k < active_.size(); ++k) z -= r[k] * all_[active_[k]].normal;
      const double infinity = std::numeric_limits<double>::infinity();
      double dual_step = infinity;
      std::size_t leaving = 0;
      for (std::size_t k = 0; k < active_.size(); ++k)
        if (r[k] > 0 && multipliers_[k] / r[k] < dual_step) dual_step = multipliers_[k] / r[k], leaving = k;
      const bool movable = active_.size() < 6 && z.norm() > dependent * n.norm();
      const double primal_step = movable ? (all_[p].offset - n.dot(y)) / z.dot(n) : infinity;
      const double step = std::min(dual_step, primal_step);
      if (step == infinity) return false;
      if (movable) y += step * z;
      for (std::size_t k = 0; k < active_.size(); ++k) multipliers_[k] -= step * r[k];
      multiplier += step;
      if (primal_step <= dual_step) {
        active_.push_back(p);
        multipliers_.push_back(multiplier);
        return true;
      }
      active_.erase(active_.begin() + leaving);
      multipliers_.erase(multipliers_.begin() + leaving);
    }
    return false;
  }

 private:
  Eigen::VectorXd in_terms_of_active(const Vec6& n) const {
    if (active_.empty()) return {};
    Eigen::Matrix<double, 6, Eigen::Dynamic> normals(6, active_.size());
    for (std::size_t k = 0; k < active_.size(); ++k) normals.col(k) = all_[active_[k]].normal;
    return normals.colPivHouseholderQr().solve(n);
  }

  std::span<const HalfSpace6> all_;
  std::vector<std::size_t> active_;
  std::vector<double> multipliers_;
};

constexpr int width = 6;             // doubles per body in a share: v, w
constexpr int friction_samples = 4;  // tangents per contact
constexpr double touching = 1e-9;    // gap relative to the lever arm below which bodies touch

/// Coordinates in which the kinetic energy metric is the unit matrix: y = S phi, covectors c = S^-T N.
struct KineticFrame {
  Mat3 spin, inverse_spin;  // spin^T spin = I_W
  double root_mass;

  KineticFrame(const Mat3& inertia_W, double mass) : root_mass(std::sqrt(mass)) {
    spin = inertia_W.llt().matrixU();
    inverse_spin = spin.inverse();
  }
  Vec6 velocity(const Vec3& w, const Vec3& v) const { return (Vec6() << spin * w, root_mass * v).finished(); }
  Vec6 covector(const Vec6& n) const {
    return (Vec6() << inverse_spin.transpose() * n.head<3>(), n.tail<3>() / root_mass).finished();
  }
  Vec3 w(const Vec6& y) const { return inverse_spin * y.head<3>(); }
  Vec3 v(const Vec6& y) const { return y.tail<3>() / root_mass; }
};

Vec6 covector_of(const Vec3& r, const Vec3& direction) {
  return (Vec6() << r.cross(direction), direction).finished();
}

double mobility(const BodySet& b, std::size_t row, const Vec3& r, const Vec3& n) {
  const Vec3 x = r.cross(n);
  return b.inverse_mass(row) + x.dot(b.inverse_inertia_W(row) * x);
}

/// Returns directions of friction; the first opposes the contact point's own velocity (F3).
std::array<Vec3, friction_samples> tangents(const Vec3& n, const Vec3& velocity) {
  Vec3 t = velocity.dot(n) * n - velocity;
  if (t.norm() <= 1e-12 * velocity.norm() || t.norm() == 0) {
    int smallest = 0;
    n.cwiseAbs().minCoeff(&smallest);
    t = n.cross(Vec3::Unit(smallest));
  }
  t.normalize();
  const Vec3 s = n.cross(t);
  return {t, s, -t, -s};
}

/// Returns -phi projected onto the span of the covectors: the friction that would stop all motion along them.
Vec6 full_stop(const std::vector<HalfSpace6>& directions, const Vec6& phi) {
  Eigen::Matrix<double, 6, Eigen::Dynamic> span(6, directions.size());
  for (std::size_t k = 0; k < directions.size(); ++k) span.col(k) = directions[k].normal;
  const auto qr = span.colPivHouseholderQr();
  const Eigen::MatrixXd q = qr.householderQ();
  const auto basis = q.leftCols(qr.rank());
  return -basis * (basis.transpose() * phi);
}

}  // namespace

ClosestPoint closest_to_origin(std::span<const HalfSpace6> constraints) {
  ActiveSet set(constraints);
  for (std::size_t i = 0; i < steps_a_constraint * (constraints.size() + 1); ++i) {
    std::size_t worst = constraints.size();
    double most = 0;
    for (std::size_t k = 0; k < constraints.size(); ++k) {
      const HalfSpace6& c = constraints[k];
      const double size = c.normal.norm();
      const double missing = (c.offset - c.normal.dot(set.y)) / size;
      if (missing > most && missing > violation * (set.y.norm() + std::abs(c.offset) / size)) {
        most = missing;
        worst = k;
      }
    }
    if (worst == constraints.size()) return {true, set.y};
    if (!set.enforce(worst)) return {false, set.y};
  }
  return {false, set.y};
}

/// (F1): either body sees of the other only the common normal velocity d after an inelastic collision.
void FfdResolver::add_constraints(const BodySet& bodies, const Contact& c, double dt) {
  const std::size_t rows[2] = {bodies.row_of(c.a), bodies.row_of(c.b)};
  const Vec3 arms[2] = {c.r_a, c.r_b};
  if (c.gap > touching * c.r_a.norm()) return;
  double speed[2], mass[2];
  for (int k = 0; k < 2; ++k) {
    const double* s = state_.data() + rows[k] * width;
    speed[k] = -c.normal.dot(Vec3(s[0], s[1], s[2]) + Vec3(s[3], s[4], s[5]).cross(arms[k]));
    mass[k] = bodies.is_dynamic(rows[k]) ? 1 / mobility(bodies, rows[k], arms[k], c.normal) : 0;
  }
  const double d =
      mass[0] > 0 && mass[1] > 0 ? (mass[0] * speed[0] + mass[1] * speed[1]) / (mass[0] + mass[1]) : 0;
  for (int k = 0; k < 2; ++k) {
    if (rows[k] >= bodies.owned || !bodies.is_dynamic(rows[k])) continue;
    const Vec3 inward = k == 0 ? Vec3(-c.normal) : c.normal;
    const double offset = k == 0 ? d : -d, own = k == 0 ? speed[0] : -speed[1];
    if (own - offset > 0) continue;
    constraints_[rows[k]].push_back({inward, arms[k], covector_of(arms[k], inward), offset,
                                     settings_.correction * std::max(0.0, -c.gap - settings_.slop) / dt,
                                     c.restitution, c.friction});
  }
}

void FfdResolver::respond(const BodySet& bodies, std::size_t row, StepVelocities& velocities,
                          ResolverStatistics& statistics) const {
  const std::vector<Constraint>& constraints = constraints_[row];
  const Mat3 rotation = bodies.orientation[row].toRotationMatrix();
  const KineticFrame frame(rotation * bodies.inertia_B[row] * rotation.transpose(), bodies.mass[row]);
  auto& [v, w] = velocities.now[row];
  const Vec6 plain = (Vec6() << w, v).finished(), phi = frame.velocity(w, v);

  // (F2): the closest velocity that satisfies all constraints
  std::vector<HalfSpace6> half_spaces;
  double bounce = 0, compression = 0, reach = 0;
  for (const Constraint& c : constraints) {
    const double missing = c.offset - c.covector.dot(plain);
    half_spaces.push_back({frame.covector(c.covector), missing + c.correction});
    bounce += c.restitution * missing;
    compression += missing;
    reach = std::max(reach, std::abs(missing + c.correction) / c.covector.norm());
  }
  const ClosestPoint feasible = closest_to_origin(half_spaces);
  if (!feasible.feasible) {
    v.setZero();
    w.setZero();
    ++statistics.infeasible;
    return;
  }
  Vec6 r = feasible.y;
  const double size = (Vec6() << frame.w(r), frame.v(r)).finished().norm();
  if (size > 1.2 * reach) r *= 1.2 * reach / size;

  // (F3): the friction of least kinetic energy
  std::vector<HalfSpace6> friction;
  const Vec3 w_feasible = w + frame.w(r), v_feasible = v + frame.v(r);
  for (std::size_t k = 0; k < constraints.size(); ++k) {
    const Constraint& c = constraints[k];
    if (c.friction <= 0) continue;
    const double bound = c.friction * std::max(0.0, half_spaces[k].normal.dot(r));
    for (const Vec3& t : tangents(c.normal, v_feasible + w_feasible.cross(c.r)))
      friction.push_back({frame.covector(covector_of(c.r, t)), bound});
  }
  Vec6 delta = Vec6::Zero();
  if (!friction.empty()) {
    const Vec6 stop = full_stop(friction, phi + r);
    for (HalfSpace6& f : friction) {  // T . (stop + y) <= bound
      f.offset = f.normal.dot(stop) - f.offset;
      f.normal = -f.normal;
    }
    const ClosestPoint bounded = closest_to_origin(friction);
    if (bounded.feasible) delta = stop + bounded.y;
  }

  // (F4)
  const double e = compression > 0 ? bounce / compression : 0;
  const Vec6 after = phi + delta + (1 + e) * r;
  v = frame.v(after);
  w = frame.w(after);
}

ResolverStatistics FfdResolver::resolve(BodySet& bodies, const std::vector<Contact>& contacts, double dt,
                                        StepVelocities& velocities, BodyExchange& exchange) {
  ResolverStatistics statistics;
  velocities.push.clear();
  if (contacts.empty()) return statistics;
  state_.resize(bodies.size() * width);
  for (const std::size_t row : velocities.rows) {
    Eigen::Map<Vec3>{state_.data() + row* width} = velocities.now[row].v;
    Eigen::Map<Vec3>{state_.data() + row* width + 3} = velocities.now[row].w;
  }
  exchange.share(bodies, state_, width);
  constraints_.resize(std::max(constraints_.size(), bodies.owned));
  for (std::size_t row = 0; row < bodies.owned; ++row) constraints_[row].clear();
  for (const Contact& c : contacts) {
    add_constraints(bodies, c, dt);
    if (bodies.row_of(c.a) < bodies.owned) ++statistics.contacts;
    statistics.penetration = std::max(statistics.penetration, -c.gap);
  }
  for (std::size_t row = 0; row < bodies.owned; ++row) {
    if (constraints_[row].empty()) continue;
    respond(bodies, row, velocities, statistics);
    velocities.misses_kick[row] = true;  // its second half
  }
  statistics.sweeps = 1;
  return statistics;
}

}  // namespace silt::rigid
