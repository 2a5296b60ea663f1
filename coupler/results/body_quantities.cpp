#include "coupler/results/body_quantities.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "coupler/case/case.hpp"
#include "coupler/energy_guard.hpp"
#include "coupler/placement/body_records.hpp"
#include "coupler/placement/place_bodies.hpp"
#include "parallel/collectives.hpp"
#include "rigid/math/elementary.hpp"
#include "rigid/shapes/shape.hpp"

namespace silt::coupler {

namespace {

using rigid::BodySet;
using rigid::ExactSum;
using rigid::Mat3;
using rigid::Vec3;

/// Adds what terms(row) gives of each owned body of a kind.
template <class Terms>
void add_terms(const BodySet& bodies, const QuantitySpec& q, Terms&& terms, std::span<ExactSum> sums) {
  for (std::size_t row = 0; row < bodies.owned; ++row) {
    if (!q.is_about(bodies.kind[row])) continue;
    const auto x = terms(row);
    for (std::size_t k = 0; k < x.size(); ++k) sums[k].add(x[k]);
  }
}

/// Sums of N terms a body, over the owned bodies of a kind on all ranks.
template <int N, class Terms>
std::array<double, N> sums_over(MPI_Comm comm, const BodySet& bodies, const QuantitySpec& q, Terms&& terms) {
  std::array<ExactSum, N> sums;
  add_terms(bodies, q, terms, sums);
  parallel::sum_over_ranks(comm, std::span(sums));
  std::array<double, N> result{};
  for (int k = 0; k < N; ++k) result[k] = sums[k].value();
  return result;
}

template <class Value>
double mean_over(const Simulation& simulation, const QuantitySpec& q, Value&& value) {
  const auto [sum, count] =
      sums_over<2>(simulation.scene().comm, simulation.bodies(), q, [&](std::size_t row) {
        return std::array<double, 2>{value(row), 1.0};
      });
  return count > 0 ? sum / count : no_value;
}

/// The bodies of the case as they are at the start, not wrapped, on the ranks where they were then.
BodySet bodies_at_start(const Scene& scene) {
  const Case& setup = scene.setup;
  const auto shapes = centred_shapes(setup);
  const PlacedBodies placed = place_bodies(setup, scene.domain, scene.comm);
  BodySet bodies;
  bodies.resize(placed.size());
  placed.for_each([&](rigid::BodyId id, const BodySpec& body) {
    const std::size_t row = bodies.owned++;
    bodies.assign(row, body_record(id, body, shapes[body.shape], setup.fluid.has_value()));
    bodies.set_velocity(row, bodies.velocity[row], bodies.angular_velocity[row]);
  });
  return bodies;
}

/// Calls visit(row, displacement since the start) for the owned bodies of a kind.
template <class Visit>
void for_each_displacement(const Simulation& simulation, const QuantitySpec& q, Visit&& visit) {
  const Case& scene = simulation.setup();
  const BodySet& bodies = simulation.bodies();
  const Vec3 period = extent_of(scene).size;
  const auto start = simulation.scene().at_start.positions.of(
      scene, simulation.scene().domain, simulation.scene().comm, std::span(bodies.id).first(bodies.owned));
  for (std::size_t row = 0; row < bodies.owned; ++row)
    if (q.is_about(bodies.kind[row]) && !start[row].hasNaN())
      visit(row, unwrapped(bodies, row, period) - start[row]);
}

// ---- what free motion keeps ----

struct Totals {
  Vec3 momentum, angular_momentum;  // of the free bodies, the latter about the domain's corner
  double energy, momentum_scale;    // kinetic and potential; sum of |m v|
};

/// A free body's part of the totals; nothing of another. The potential is zero at the corner of the domain
/// that is lowest against gravity.
std::array<double, 8> totals_of_body(const Case& scene, const BodySet& bodies, std::size_t row) {
  if (!bodies.is_dynamic(row)) return {};
  const Vec3 period = extent_of(scene).size, g = scene.gravity;
  Vec3 lowest = Vec3::Zero();
  for (int d = 0; d < 3; ++d) lowest[d] = g[d] > 0 ? period[d] : 0;
  const Vec3 x = unwrapped(bodies, row, period), p = bodies.mass[row] * bodies.velocity[row];
  const Vec3 l = x.cross(p) + bodies.angular_momentum[row];
  const double potential = -bodies.mass[row] * bodies.weight_in_fluid[row] * g.dot(x - lowest);
  return {p[0], p[1], p[2], l[0], l[1], l[2], bodies.kinetic_energy(row) + potential, p.norm()};
}

Totals totals_from(std::span<const double> sums) {
  return {{sums[0], sums[1], sums[2]}, {sums[3], sums[4], sums[5]}, sums[6], sums[7]};
}

std::array<double, 8> sums_of_totals(const Case& scene, MPI_Comm comm, const BodySet& bodies,
                                     const QuantitySpec& q) {
  return sums_over<8>(comm, bodies, q, [&](std::size_t row) { return totals_of_body(scene, bodies, row); });
}

Totals totals_now(const Simulation& simulation, const QuantitySpec& q) {
  return totals_from(sums_of_totals(simulation.setup(), simulation.scene().comm, simulation.bodies(), q));
}

/// What `keep` keeps of the totals at the start: the history has it, or for a quantity that was not there
/// then the case, whose bodies are placed anew.
QuantityHistory start_of(const Simulation& simulation, const QuantitySpec& q, const QuantityHistory& history,
                         decltype(StepSums::fold) keep) {
  if (history != no_history) return history;
  const Scene& scene = simulation.scene();
  const auto sums = sums_of_totals(scene.setup, scene.comm, bodies_at_start(scene), q);
  QuantityHistory start = no_history;
  keep(scene.setup, q, 0, sums, start);
  return start;
}

double relative(double change, double start) {
  return start == 0 ? no_value : change / start;
}

}  // namespace

double mean_over_bodies(const Simulation& simulation, const QuantitySpec& q,
                        const std::function<double(std::size_t)>& value) {
  return mean_over(simulation, q, value);
}

// ---- at the end ----

double mean_height(const Simulation& simulation, const QuantitySpec& q) {
  const BodySet& bodies = simulation.bodies();
  return mean_over(simulation, q, [&](std::size_t row) { return bodies.position[row][q.axis]; });
}

double drift(const Simulation& simulation, const QuantitySpec& q) {
  double furthest = not_yet;
  for_each_displacement(simulation, q,
                        [&](std::size_t, const Vec3& moved) { furthest = std::max(furthest, moved.norm()); });
  furthest = parallel::max_over_ranks(simulation.scene().comm, furthest);
  return furthest == not_yet ? no_value : furthest;
}

double displacement(const Simulation& simulation, const QuantitySpec& q) {
  using Terms = std::array<double, 2>;  // the displacement, and 1 of a body that was there at the start
  std::vector<Terms> terms(simulation.bodies().owned, Terms{});
  for_each_displacement(simulation, q, [&](std::size_t row, const Vec3& moved) {
    terms[row] = {moved[q.axis], 1};
  });
  const auto [sum, count] = sums_over<2>(simulation.scene().comm, simulation.bodies(), q,
                                         [&](std::size_t row) { return terms[row]; });
  return count > 0 ? sum / count : no_value;
}

double mean_velocity(const Simulation& simulation, const QuantitySpec& q) {
  const BodySet& bodies = simulation.bodies();
  return mean_over(simulation, q, [&](std::size_t row) { return bodies.velocity[row][q.axis]; });
}

double mean_angular_velocity(const Simulation& simulation, const QuantitySpec& q) {
  const BodySet& bodies = simulation.bodies();
  return mean_over(simulation, q, [&](std::size_t row) { return bodies.angular_velocity[row][q.axis]; });
}

bool add_totals_at_start(const Simulation& simulation, const QuantitySpec& q, const QuantityHistory&,
                         std::span<ExactSum> sums) {
  if (simulation.steps_done() > 0) return false;
  const BodySet& bodies = simulation.bodies();
  add_terms(
      bodies, q, [&](std::size_t row) { return totals_of_body(simulation.setup(), bodies, row); }, sums);
  return true;
}

void keep_momentum(const Case&, const QuantitySpec& q, std::int64_t, std::span<const double> sums,
                   QuantityHistory& start) {
  const Totals totals = totals_from(sums);
  start = {totals.momentum[q.axis], totals.momentum_scale, 0};
}

double momentum_change(const Simulation& simulation, const QuantitySpec& q, const QuantityHistory& history) {
  const QuantityHistory start = start_of(simulation, q, history, keep_momentum);
  return relative(totals_now(simulation, q).momentum[q.axis] - start[0], start[1]);
}

void keep_angular_momentum(const Case&, const QuantitySpec&, std::int64_t, std::span<const double> sums,
                           QuantityHistory& start) {
  const Vec3 l = totals_from(sums).angular_momentum;
  start = {l[0], l[1], l[2]};
}

double angular_momentum_change(const Simulation& simulation, const QuantitySpec& q,
                               const QuantityHistory& history) {
  const QuantityHistory kept = start_of(simulation, q, history, keep_angular_momentum);
  const Vec3 start(kept[0], kept[1], kept[2]);
  return relative((totals_now(simulation, q).angular_momentum - start).norm(), start.norm());
}

void keep_energy(const Case&, const QuantitySpec&, std::int64_t, std::span<const double> sums,
                 QuantityHistory& start) {
  start = {totals_from(sums).energy, 0, 0};
}

double energy_change(const Simulation& simulation, const QuantitySpec& q, const QuantityHistory& history) {
  const double start = start_of(simulation, q, history, keep_energy)[0];
  return relative(totals_now(simulation, q).energy - start, start);
}

double bodies_in_box(const Simulation& simulation, const QuantitySpec& q) {
  const BodySet& bodies = simulation.bodies();
  std::uint64_t inside = 0;
  for (std::size_t row = 0; row < bodies.owned; ++row) {
    const auto x = bodies.position[row].array();
    inside +=
        q.is_about(bodies.kind[row]) && (x >= q.box.lower.array()).all() && (x <= q.box.upper.array()).all();
  }
  return static_cast<double>(parallel::sum_over_ranks(simulation.scene().comm, inside));
}

double max_penetration(const Simulation& simulation) {
  return simulation.counters().penetration;
}

// ---- over the run ----

void observe_speed(const Simulation& simulation, const QuantitySpec& q, QuantityHistory& largest) {
  const BodySet& bodies = simulation.bodies();
  for (std::size_t row = 0; row < bodies.owned; ++row)
    if (q.is_about(bodies.kind[row])) largest[0] = std::max(largest[0], bodies.velocity[row].norm());
}

void observe_height(const Simulation& simulation, const QuantitySpec& q, QuantityHistory& largest) {
  if (static_cast<double>(simulation.steps_done()) < q.time) return;
  const BodySet& bodies = simulation.bodies();
  for (std::size_t row = 0; row < bodies.owned; ++row)
    if (q.is_about(bodies.kind[row])) largest[0] = std::max(largest[0], bodies.position[row][q.axis]);
}

void observe_rebound(const Simulation& simulation, const QuantitySpec& q,
                     QuantityHistory& against_and_along) {
  const BodySet& bodies = simulation.bodies();
  for (std::size_t row = 0; row < bodies.owned; ++row) {
    if (!q.is_about(bodies.kind[row]) || bodies.position[row][q.axis] < q.height) continue;
    const double v = bodies.velocity[row][q.axis];
    against_and_along[0] = std::max(against_and_along[0], -v);
    against_and_along[1] = std::max(against_and_along[1], v);
  }
}

double rebound_ratio(const Simulation&, const QuantitySpec&, const QuantityHistory& against_and_along) {
  const double against = against_and_along[0], along = against_and_along[1];
  return against > 0 ? std::max(along, 0.0) / against : no_value;
}

/// The spin about the axis of the middle moment of inertia, and (Euler's equation without a torque) its rate
/// of change, tell from the state alone how long ago it was zero.
void observe_reversal(const Simulation& simulation, const QuantitySpec& q, QuantityHistory& latest) {
  const BodySet& bodies = simulation.bodies();
  for (std::size_t row = 0; row < bodies.owned; ++row) {
    if (!q.is_about(bodies.kind[row]) || !bodies.is_dynamic(row)) continue;
    const Mat3& inertia = bodies.inertia_B[row];
    const Vec3 middle = Eigen::SelfAdjointEigenSolver<Mat3>(inertia).eigenvectors().col(1);
    const Vec3 w = bodies.orientation[row].conjugate() * bodies.angular_velocity[row];
    const double since = middle.dot(w) / middle.dot(inertia.inverse() * (inertia * w).cross(w));
    const double now = static_cast<double>(simulation.steps_done());
    if (since >= 0 && since <= std::min(1.0, now)) latest[0] = std::max(latest[0], now - since);
  }
}

bool add_energy(const Simulation& simulation, const QuantitySpec& q, const QuantityHistory&,
                std::span<ExactSum> energy) {
  const BodySet& bodies = simulation.bodies();
  add_terms(
      bodies, q,
      [&](std::size_t row) { return std::array{totals_of_body(simulation.setup(), bodies, row)[6]}; },
      energy);
  return true;
}

void keep_largest_energy(const Case&, const QuantitySpec&, std::int64_t, std::span<const double> now,
                         QuantityHistory& energy) {
  if (energy[0] == not_yet) energy[0] = now[0];
  energy[1] = std::max(energy[1], now[0]);
}

double energy_growth(const Simulation&, const QuantitySpec&, const QuantityHistory& energy) {
  return energy[0] == not_yet ? no_value : relative(energy[1] - energy[0], energy[0]);
}

namespace {

double mass_below(const BodySet& bodies, const QuantitySpec& q, std::size_t row) {
  return bodies.position[row][q.axis] < q.height ? bodies.mass[row] : 0;
}

}  // namespace

bool add_mass_below(const Simulation& simulation, const QuantitySpec& q, const QuantityHistory& start,
                    std::span<ExactSum> mass) {
  if (start[0] != not_yet || static_cast<double>(simulation.steps_done()) < q.time) return false;
  const BodySet& bodies = simulation.bodies();
  add_terms(
      bodies, q, [&](std::size_t row) { return std::array{mass_below(bodies, q, row)}; }, mass);
  return true;
}

void keep_first_mass(const Case&, const QuantitySpec&, std::int64_t step, std::span<const double> mass,
                     QuantityHistory& start) {
  if (start[0] == not_yet) start = {mass[0], static_cast<double>(step), 0};
}

double discharge_rate(const Simulation& simulation, const QuantitySpec& q, const QuantityHistory& start) {
  const BodySet& bodies = simulation.bodies();
  const auto [now] = sums_over<1>(simulation.scene().comm, bodies, q,
                                  [&](std::size_t row) { return std::array{mass_below(bodies, q, row)}; });
  const double duration = static_cast<double>(simulation.steps_done()) - start[1];
  return start[0] == not_yet || duration == 0 ? no_value : (now - start[0]) / duration;
}

void observe_outflow(const Simulation& simulation, const QuantitySpec& q, QuantityHistory& start) {
  const double now = static_cast<double>(simulation.steps_done());
  if (start[0] == not_yet && now >= q.time) start = {static_cast<double>(simulation.counters().left), now};
}

double outflow_rate(const Simulation& simulation, const QuantitySpec&, const QuantityHistory& start) {
  const double duration = static_cast<double>(simulation.steps_done()) - start[1];
  if (start[0] == not_yet || duration == 0) return no_value;
  return (static_cast<double>(simulation.counters().left) - start[0]) / duration;
}

}  // namespace silt::coupler
