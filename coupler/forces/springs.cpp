#include "coupler/forces/springs.hpp"

#include <Eigen/SparseCholesky>
#include <algorithm>
#include <cmath>
#include <cstring>
#include <map>
#include <numeric>

#include "coupler/exchange/coupling_state.hpp"
#include "coupler/spec/flow_spec.hpp"

namespace silt::coupler {

using rigid::BodyId;
using rigid::BodySet;
using rigid::Mat3;
using rigid::Vec3;

namespace {

using Vector = Eigen::VectorXd;
using Matrix = Eigen::SparseMatrix<double>;
using Entries = std::vector<Eigen::Triplet<double>>;

constexpr int freedoms = 6;  // degrees of freedom of a body

void put(Entries& entries, Eigen::Index row, Eigen::Index column, const Mat3& block) {
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) entries.emplace_back(row + i, column + j, block(i, j));
}

Matrix matrix_of(const Entries& entries, Eigen::Index rows, Eigen::Index columns) {
  Matrix matrix(rows, columns);
  matrix.setFromTriplets(entries.begin(), entries.end());
  return matrix;
}

/// Returns the matrix from the bodies' motions to the relative motions of the springs' ends. Motions are
/// scaled to unit mass and inertia, so the transpose maps forces to motions.
Matrix parting(std::span<const SpringInStep> springs, std::span<const Yield> bodies) {
  Entries entries;
  for (std::size_t k = 0; k < springs.size(); ++k)
    for (int end = 0; end < 2; ++end) {
      const int body = springs[k].bodies[end];
      if (body < 0) continue;
      const Yield& yield = bodies[std::size_t(body)];
      const double sign = end == 0 ? -1 : 1;
      Mat3 turned;
      for (int d = 0; d < 3; ++d) turned.col(d) = sign * yield.about.col(d).cross(springs[k].arms[end]);
      put(entries, Eigen::Index(3 * k), freedoms * body, Mat3((sign * yield.along).asDiagonal()));
      put(entries, Eigen::Index(3 * k), freedoms * body + 3, turned);
    }
  return matrix_of(entries, Eigen::Index(3 * springs.size()), Eigen::Index(freedoms * bodies.size()));
}

/// Returns the block-diagonal matrix of the dampers.
Matrix dampers(std::span<const SpringInStep> springs) {
  Entries entries;
  for (std::size_t k = 0; k < springs.size(); ++k)
    put(entries, Eigen::Index(3 * k), Eigen::Index(3 * k), springs[k].damping);
  return matrix_of(entries, Eigen::Index(3 * springs.size()), Eigen::Index(3 * springs.size()));
}

Vector stacked(std::span<const SpringInStep> springs, Vec3 SpringInStep::*of) {
  Vector all(Eigen::Index(3 * springs.size()));
  for (std::size_t k = 0; k < springs.size(); ++k) all.segment<3>(Eigen::Index(3 * k)) = springs[k].*of;
  return all;
}

}  // namespace

std::vector<Vec3> forces_of(std::span<const SpringInStep> springs, std::span<const Yield> bodies) {
  Vector force = stacked(springs, &SpringInStep::force);
  const auto is_damped = [](const SpringInStep& spring) { return !spring.damping.isZero(0); };
  if (std::ranges::any_of(springs, is_damped)) {
    const Matrix parts = parting(springs, bodies), moves = parts.transpose(), damping = dampers(springs);
    const double beta = (3 + std::sqrt(3.0)) / 6;
    const double weights[][2] = {{beta, beta}, {beta, 1.0 / 6}, {1 - 2 * beta, 1.0 / 3 - beta}};  // (50b)
    Matrix one(moves.rows(), moves.rows());
    one.setIdentity();
    const Eigen::SimplicialLDLT<Matrix> damped(Matrix(one + beta * (moves * damping * parts)));
    Vector rate = stacked(springs, &SpringInStep::rate),
           gain = stacked(springs, &SpringInStep::gain) - parts * (moves * force);
    for (const auto& [of_rate, of_gain] : weights) {
      rate -= beta * (parts * damped.solve(moves * (damping * rate)));
      gain -= beta * (parts * damped.solve(moves * (damping * gain)));
      force += damping * (of_rate * rate + of_gain * gain);
    }
  }
  std::vector<Vec3> forces;
  for (std::size_t k = 0; k < springs.size(); ++k) forces.emplace_back(force.segment<3>(Eigen::Index(3 * k)));
  return forces;
}

namespace {

/// The data of a body that all ranks need.
struct SharedBody : rigid::Kinematics {
  double gain[6] = {}, along[3] = {}, about[9] = {};
};
constexpr double most_damping =
    1e4;  // times the compliance: stronger dampers stop the motion as fast, up to rounding
constexpr std::size_t words = sizeof(SharedBody) / sizeof(std::int64_t);

SharedBody shared_of(const BodySet& bodies, std::size_t row) {
  SharedBody told{bodies.kinematics(row)};
  Yield yield;
  if (bodies.is_dynamic(row)) {
    yield.along = bodies.unlocked(row, Vec3::Constant(1 / std::sqrt(bodies.mass[row])));
    yield.about = Eigen::SelfAdjointEigenSolver<Mat3>(bodies.inverse_inertia_W(row)).operatorSqrt();
  }
  const auto& sprung = coupling_of(bodies, row).sprung_velocity;
  Eigen::Map<Vec6>{told.gain} << bodies.velocity[row] - sprung.linear(),
      bodies.angular_velocity[row] - sprung.angular();
  std::copy_n(yield.along.data(), 3, told.along);
  std::copy_n(yield.about.data(), 9, told.about);
  return told;
}

/// Returns, by id, the first body of each body's set, connected by springs and free bodies.
std::vector<BodyId> first_of_sets(std::span<const SpringSpec> springs,
                                  std::span<const rigid::Motion> motions) {
  std::vector<BodyId> first(motions.size() + 1);
  std::iota(first.begin(), first.end(), BodyId{0});
  const auto root = [&](BodyId id) {
    while (first[id] != id) id = first[id] = first[first[id]];
    return id;
  };
  const auto moves = [&](BodyId id) { return id != 0 && motions[id - 1] == rigid::Motion::free; };
  for (const SpringSpec& spring : springs)
    if (moves(spring.body) && moves(spring.to)) {
      const auto [low, high] = std::minmax({root(spring.body), root(spring.to)});
      first[high] = low;
    }
  for (BodyId id = 0; id < first.size(); ++id) first[id] = root(id);
  return first;
}

void sort_once(std::vector<BodyId>& ids) {
  std::sort(ids.begin(), ids.end());
  ids.erase(std::unique(ids.begin(), ids.end()), ids.end());
}

}  // namespace

Springs::Springs(std::span<const SpringSpec> springs, std::span<const rigid::Motion> motions,
                 const rigid::Extent& extent, MPI_Comm comm)
    : extent_(extent), comm_(comm) {
  const std::vector<BodyId> first = first_of_sets(springs, motions);
  std::map<BodyId, Set> sets;
  for (const SpringSpec& spring : springs) {
    const bool moves = motions[spring.body - 1] == rigid::Motion::free;
    Set& set = sets[first[moves ? spring.body : spring.to]];
    set.springs.push_back(spring);
    set.bodies.push_back(spring.body);
    bodies_.push_back(spring.body);
    if (spring.to == 0) continue;
    bodies_.push_back(spring.to);
    set.bodies.push_back(spring.to);
    shared_.insert(shared_.end(), {spring.body, spring.to});
  }
  for (auto& [id, set] : sets) sort_once(set.bodies), sets_.push_back(std::move(set));
  sort_once(shared_), sort_once(bodies_);
}

void Springs::start(BodySet& bodies, std::size_t row) {
  coupling_of(bodies, row).sprung_velocity() << bodies.velocity[row], bodies.angular_velocity[row];
}

void Springs::start(BodySet& bodies) {
  for (const BodyId id : bodies_)
    if (const std::size_t row = bodies.row_of(id); row < bodies.owned) start(bodies, row);
}

/// Each body has one owner, and zeros from other ranks add nothing to its bits.
void Springs::share(const BodySet& bodies) {
  if (shared_.empty()) return;
  std::vector<std::int64_t> mine(words * shared_.size());
  for (std::size_t k = 0; k < shared_.size(); ++k)
    if (const std::size_t row = bodies.row_of(shared_[k]); row < bodies.owned) {
      const SharedBody told = shared_of(bodies, row);
      std::memcpy(&mine[words * k], &told, sizeof told);
    }
  sums_.start(comm_, std::move(mine));
}

void Springs::add_forces(BodySet& bodies) {
  for (const BodyId id : bodies_)
    if (const std::size_t row = bodies.row_of(id); row < bodies.owned)
      coupling_of(bodies, row).spring_load = {};
  if (!shared_.empty()) shared_bits_ = sums_.finish();
  const auto is_here = [&](BodyId id) { return bodies.row_of(id) < bodies.owned; };
  for (const Set& set : sets_)
    if (std::ranges::any_of(set.bodies, is_here)) add_forces(bodies, set);
}

void Springs::subtract_from_loads(BodySet& bodies) const {
  for (const BodyId id : bodies_)
    if (const std::size_t row = bodies.row_of(id); row < bodies.owned)
      coupling_of(bodies, row).seen_load() -= coupling_of(bodies, row).spring_load();
}

/// Returns the body after the first half of the drift, before forces; nothing for one that has left.
std::optional<Springs::Sprung> Springs::sprung(const BodySet& bodies, BodyId id) const {
  const auto found = std::lower_bound(shared_.begin(), shared_.end(), id);
  SharedBody told;
  if (found != shared_.end() && *found == id) {
    std::memcpy(static_cast<void*>(&told), &shared_bits_[words * (found - shared_.begin())], sizeof told);
  } else {
    const std::size_t row = bodies.row_of(id);
    if (row >= bodies.owned) return {};
    told = shared_of(bodies, row);
  }
  const rigid::Quat q(told.orientation[0], told.orientation[1], told.orientation[2], told.orientation[3]);
  if (q.squaredNorm() == 0) return {};
  const rigid::Twist twist{Vec3(told.velocity), Vec3(told.angular_velocity)};
  return Sprung{{Vec3(told.position) + 0.5 * twist.v, rigid::cayley(0.5 * twist.w) * q},
                twist,
                {Vec3(told.gain), Vec3(told.gain + 3)},
                {Vec3(told.along), Mat3(told.about)}};
}

/// method.md, equations 49 and 50, at the positions of the bodies.
SpringInStep Springs::in_step(const SpringSpec& spec, const Sprung& a, const Sprung& b) const {
  SpringInStep spring;
  spring.bodies = {-1, -1};
  spring.arms = {a.pose.orientation * spec.arm, b.pose.orientation * spec.to_arm};
  const auto& [arm_a, arm_b] = spring.arms;
  const Vec3 apart = nearest_image(b.pose.position + arm_b - a.pose.position - arm_a, extent_);
  spring.rate = b.twist.at(arm_b) - a.twist.at(arm_a);
  spring.gain = b.gain.at(arm_b) - a.gain.at(arm_a);
  const double damping = std::min(spec.damping, most_damping / (spec.compliance[0] + spec.compliance[1]));
  const double distance = apart.norm();
  const Vec3 along = distance > 0 ? Vec3(apart / distance) : Vec3(Vec3::Zero());
  spring.force = spec.stiffness * (apart - spec.length * along);
  spring.damping = damping * (spec.length > 0 ? Mat3(along * along.transpose()) : Mat3(Mat3::Identity()));
  return spring;
}

/// All ranks with a body of a set compute the same forces.
void Springs::add_forces(BodySet& bodies, const Set& set) {
  std::vector<std::optional<Sprung>> sprung_ones;
  std::vector<Yield> yields;
  for (const BodyId id : set.bodies) {
    sprung_ones.push_back(sprung(bodies, id));
    yields.push_back(sprung_ones.back() ? sprung_ones.back()->yield : Yield{});
  }
  const auto index = [&](BodyId id) {
    return int(std::ranges::lower_bound(set.bodies, id) - set.bodies.begin());
  };
  for (const BodyId id : set.bodies)
    if (const std::size_t row = bodies.row_of(id); row < bodies.owned) start(bodies, row);
  std::vector<SpringInStep> springs;
  std::vector<const SpringSpec*> specs;
  for (const SpringSpec& spec : set.springs) {
    const int a = index(spec.body), b = spec.to == 0 ? -1 : index(spec.to);
    const auto& first = sprung_ones[a];
    const auto second = b < 0 ? std::optional<Sprung>(Sprung{}) : sprung_ones[b];
    if (!first || !second) continue;
    springs.push_back(in_step(spec, *first, *second));
    springs.back().bodies = {a, b};
    specs.push_back(&spec);
  }
  if (springs.empty()) return;
  const std::vector<Vec3> forces = forces_of(springs, yields);
  for (std::size_t k = 0; k < springs.size(); ++k) {
    add(bodies, specs[k]->body, forces[k], springs[k].arms[0]);
    if (specs[k]->to != 0) add(bodies, specs[k]->to, -forces[k], springs[k].arms[1]);
  }
}

void Springs::add(BodySet& bodies, BodyId id, const Vec3& force, const Vec3& arm) {
  const std::size_t row = bodies.row_of(id);
  if (row >= bodies.owned || !bodies.is_dynamic(row)) return;
  const Vec3 torque = arm.cross(force);
  bodies.add_force(row, force);
  bodies.add_torque(row, torque);
  CouplingState& state = coupling_of(bodies, row);
  state.spring_load.linear() += force;
  state.spring_load.angular() += torque;
  state.sprung_velocity.linear() += bodies.unlocked(row, force / bodies.mass[row]);
  state.sprung_velocity.angular() += bodies.inverse_inertia_W(row) * torque;
}

}  // namespace silt::coupler
