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
  const auto start = simulation.scene().starts.of(scene, simulation.scene().domain, simulation.scene().comm,
                                                  std::span(bodies.id).first(bodies.owned));
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

// ---- sampled volume ----

constexpr int samples_per_radius = 8;

/// A point in each of the equal cells of a box, on a sheared lattice, so that none of its rows lies along the
/// surface of a body that is aligned with the axes. Along an axis on which it has the whole of a period it
/// has no end.
struct SampledBox {
  Vec3 lower, upper, spacing;
  std::array<std::int64_t, 3> count;
  std::array<bool, 3> endless;

  SampledBox(const QuantitySpec& q, double widest, const rigid::Extent& extent)
      : lower(q.lower), upper(q.upper) {
    for (int d = 0; d < 3; ++d) {
      const double edge = upper[d] - lower[d];
      count[d] = std::max<std::int64_t>(1, std::llround(std::ceil(edge / widest)));
      spacing[d] = edge / static_cast<double>(count[d]);
      endless[d] = extent.periodic[d] && edge >= extent.size[d];
    }
  }
  double volume() const { return (upper - lower).prod(); }
  bool meets(const rigid::BoundingBox& b) const {
    for (int d = 0; d < 3; ++d)
      if (!endless[d] && (b.upper[d] < lower[d] || b.lower[d] > upper[d])) return false;
    return true;
  }
  bool holds(const rigid::BoundingBox& b) const {
    for (int d = 0; d < 3; ++d)
      if (!endless[d] && (b.lower[d] < lower[d] || b.upper[d] > upper[d])) return false;
    return true;
  }
  std::int64_t cell(int d, double x) const {
    const std::int64_t at = std::llround(std::floor((x - lower[d]) / spacing[d]));
    return endless[d] ? at : std::clamp<std::int64_t>(at, 0, count[d] - 1);
  }
  Vec3 point(std::int64_t i, std::int64_t j, std::int64_t k) const {
    constexpr double shear_x = 0.6180339887498949, shear_y = 0.7548776662466927;  // badly approximable
    const double x = static_cast<double>(i), y = static_cast<double>(j), z = static_cast<double>(k);
    const double shift_y = shear_x * x, shift_z = shear_y * y + shear_x * x;
    return lower + spacing.cwiseProduct(
                       Vec3(x + 0.5, y + shift_y - std::floor(shift_y), z + shift_z - std::floor(shift_z)));
  }
};

/// How much of a line along z through x, from there to `length` above it, is inside any of the parts.
double length_inside(const Vec3& x, double length, std::span<const rigid::Part> parts,
                     const rigid::Pose& pose) {
  const Vec3 first = pose.to_body(x), up = pose.orientation.conjugate() * Vec3::UnitZ();
  std::vector<std::pair<double, double>> intervals;
  for (const rigid::Part& part : parts)
    if (const auto in = rigid::line_interval(part.shape, part.pose.to_body(first),
                                             part.pose.orientation.conjugate() * up))
      intervals.emplace_back(std::max(in->enter, 0.0), std::min(in->leave, length));
  std::sort(intervals.begin(), intervals.end());
  double inside = 0, covered = 0;  // the union so far reaches up to here
  for (const auto& [enter, leave] : intervals) {
    inside += std::max(0.0, leave - std::max(enter, covered));
    covered = std::max(covered, leave);
  }
  return inside;
}

/// What of a body's volume lies in the box: exact for a convex body all inside, along lines for convex parts,
/// else by points.
double volume_inside(const SampledBox& box, const rigid::Shape& shape, const rigid::Pose& pose) {
  const rigid::BoundingBox bounds = rigid::bounding_box(shape, pose);
  if (!box.meets(bounds)) return 0;
  const std::vector<rigid::Part> parts = rigid::convex_parts(shape);
  if (parts.size() == 1 && box.holds(bounds)) return rigid::mass_properties(shape).volume;
  std::array<std::int64_t, 3> from, to;
  for (int d = 0; d < 3; ++d) from[d] = box.cell(d, bounds.lower[d]), to[d] = box.cell(d, bounds.upper[d]);
  const double bottom = box.endless[2] ? bounds.lower[2] : std::max(bounds.lower[2], box.lower[2]);
  const double top = box.endless[2] ? bounds.upper[2] : std::min(bounds.upper[2], box.upper[2]);
  double length = 0;  // of lines through the points' columns
  for (std::int64_t j = from[1]; j <= to[1]; ++j)
    for (std::int64_t i = from[0]; i <= to[0]; ++i) {
      const Vec3 x = box.point(i, j, 0);
      if (!parts.empty())
        length += length_inside({x[0], x[1], bottom}, top - bottom, parts, pose);
      else
        for (std::int64_t k = from[2]; k <= to[2]; ++k)
          length += rigid::contains(shape, pose.to_body(box.point(i, j, k))) * box.spacing[2];
    }
  return length * box.spacing[0] * box.spacing[1];
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
    inside += q.is_about(bodies.kind[row]) && (x >= q.lower.array()).all() && (x <= q.upper.array()).all();
  }
  return static_cast<double>(parallel::sum_over_ranks(simulation.scene().comm, inside));
}

double packing_fraction(const Simulation& simulation, const QuantitySpec& q) {
  const Scene& scene = simulation.scene();
  const BodySet& bodies = simulation.bodies();
  const rigid::Extent extent = extent_of(simulation.setup());
  double radius = std::numeric_limits<double>::infinity();
  for (const double r : scene.world.bounding_radii) radius = std::min(radius, r);
  const SampledBox box(q, radius / samples_per_radius, extent);
  std::array<int, 3> reach;  // to the images that are looked at one by one
  for (int d = 0; d < 3; ++d) reach[d] = extent.periodic[d] && !box.endless[d];
  const auto volume = [&](std::size_t row) {
    double sum = 0;
    rigid::Image i;
    for (i.x = -reach[0]; i.x <= reach[0]; ++i.x)
      for (i.y = -reach[1]; i.y <= reach[1]; ++i.y)
        for (i.z = -reach[2]; i.z <= reach[2]; ++i.z)
          sum += volume_inside(box, scene.world.shapes[bodies.shape[row]],
                               {bodies.position[row] + extent.shift(i), bodies.orientation[row]});
    return std::array<double, 1>{sum};
  };
  return sums_over<1>(scene.comm, bodies, q, volume)[0] / box.volume();
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
