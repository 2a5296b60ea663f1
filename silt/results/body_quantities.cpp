// Quantities of the bodies; sums are exact. Positions at the start are recomputed from the case.
#include <algorithm>
#include <numbers>

#include "parallel/collectives.hpp"
#include "rigid/math/elementary.hpp"
#include "silt/case/case.hpp"
#include "silt/fault_watch.hpp"
#include "silt/placement/place_bodies.hpp"
#include "silt/results/quantity_computation.hpp"

namespace silt {

namespace {

using rigid::BodySet;
using rigid::ExactSum;
using rigid::Mat3;
using rigid::Vec3;

/// Returns the sums over all ranks of N terms per body.
template <int N, class Terms>
std::array<double, N> sums_over(MPI_Comm comm, const BodySet& bodies, const QuantitySpec& q, Terms&& terms) {
  std::array<ExactSum, N> sums;
  for_bodies_of(bodies, q, [&](std::size_t row) {
    const std::array<double, N> x = terms(row);
    for (int k = 0; k < N; ++k) sums[k].add(x[k]);
  });
  parallel::sum_over_ranks(comm, std::span(sums));
  std::array<double, N> result{};
  for (int k = 0; k < N; ++k) result[k] = sums[k].value();
  return result;
}

double ratio(double change, double start) {
  return start == 0 ? no_value : change / start;
}

// ---- displacements ----

/// Calls visit(row, displacement since the start) for owned bodies that existed then.
template <class Visit>
void for_each_displacement(const Simulation& simulation, const QuantitySpec& q, Visit&& visit) {
  const Scene& scene = simulation.scene();
  const BodySet& bodies = simulation.bodies();
  const Vec3 period = extent_of(scene.setup).size;
  const auto start = scene.at_start.positions.of(scene.setup, scene.domain, scene.comm,
                                                 std::span(bodies.id).first(bodies.owned));
  for_bodies_of(bodies, q, [&](std::size_t row) {
    if (!start[row].hasNaN()) visit(row, unwrapped(bodies, row, period) - start[row]);
  });
}

double drift(const Simulation& simulation, const QuantitySpec& q) {
  double furthest = not_yet;
  for_each_displacement(simulation, q,
                        [&](std::size_t, const Vec3& moved) { furthest = std::max(furthest, moved.norm()); });
  furthest = parallel::max_over_ranks(simulation.scene().comm, furthest);
  return furthest == not_yet ? no_value : furthest;
}

double displacement(const Simulation& simulation, const QuantitySpec& q) {
  using Terms = std::array<double, 2>;  // displacement, and 1 if the body existed at the start
  std::vector<Terms> terms(simulation.bodies().owned, Terms{});
  for_each_displacement(simulation, q, [&](std::size_t row, const Vec3& moved) {
    terms[row] = {moved[q.axis], 1};
  });
  const auto [sum, count] = sums_over<2>(simulation.scene().comm, simulation.bodies(), q,
                                         [&](std::size_t row) { return terms[row]; });
  return ratio(sum, count);
}

// ---- invariants of free motion ----

struct Totals {
  Vec3 momentum, angular_momentum;  // of free bodies; about the corner of the domain
  double energy, momentum_scale;    // kinetic and potential; sum of |m v|

  static Totals from(std::span<const double> sums) {
    return {{sums[0], sums[1], sums[2]}, {sums[3], sums[4], sums[5]}, sums[6], sums[7]};
  }
};

/// Returns the part of a free body in the totals. The potential is zero at the lowest corner of the domain.
std::array<double, 8> totals_of_body(const Case& setup, const BodySet& bodies, std::size_t row) {
  if (!bodies.is_dynamic(row)) return {};
  const Vec3 period = extent_of(setup).size, g = setup.gravity;
  Vec3 lowest = Vec3::Zero();
  for (int d = 0; d < 3; ++d) lowest[d] = g[d] > 0 ? period[d] : 0;
  const Vec3 x = unwrapped(bodies, row, period), p = bodies.mass[row] * bodies.velocity[row];
  const Vec3 l = x.cross(p) + bodies.angular_momentum[row];
  const double potential = -bodies.mass[row] * bodies.weight_in_fluid[row] * g.dot(x - lowest);
  return {p[0], p[1], p[2], l[0], l[1], l[2], bodies.kinetic_energy(row) + potential, p.norm()};
}

Totals totals_of(const Scene& scene, const BodySet& bodies, const QuantitySpec& q) {
  return Totals::from(sums_over<8>(
      scene.comm, bodies, q, [&](std::size_t row) { return totals_of_body(scene.setup, bodies, row); }));
}

std::array<double, 8> totals(const Simulation& simulation, const QuantitySpec&, std::size_t row) {
  return totals_of_body(simulation.setup(), simulation.bodies(), row);
}

bool is_at_start(const Simulation& simulation, const QuantitySpec&, const QuantityHistory&) {
  return simulation.steps_done() == 0;
}

/// Returns the bodies of the case at the start, not wrapped, on their ranks then.
BodySet bodies_at_start(const Scene& scene) {
  const auto shapes = centred_shapes(scene.setup);
  const PlacedBodies placed = place_bodies(scene.setup, scene.domain, scene.comm);
  BodySet bodies;
  bodies.resize(placed.size());
  placed.for_each([&](rigid::BodyId id, const BodySpec& body) {
    const std::size_t row = bodies.owned++;
    bodies.assign(row, body_record(id, body, shapes[body.shape], scene.setup.fluid.has_value()));
    bodies.set_velocity(row, bodies.velocity[row], bodies.angular_velocity[row]);
  });
  return bodies;
}

/// change(present value, start value), where kept(totals, spec) is the history with the start value. For a
/// quantity that is new after a resume, the bodies of the case are placed again.
template <auto kept, auto change>
constexpr Computation since_start() {
  return {nullptr,
          [](const Simulation& simulation, const QuantitySpec& q, const QuantityHistory& history) {
            const Scene& scene = simulation.scene();
            const QuantityHistory start =
                history != no_history ? history : kept(totals_of(scene, bodies_at_start(scene), q), q);
            return change(kept(totals_of(scene, simulation.bodies(), q), q), start);
          },
          {8, add_over_bodies<totals>, is_at_start},
          [](const Case&, const QuantitySpec& q, std::int64_t, std::span<const double> sums,
             QuantityHistory& start) { start = kept(Totals::from(sums), q); },
          nullptr,
          {},
          true};
}

QuantityHistory kept_momentum(const Totals& t, const QuantitySpec& q) {
  return {t.momentum[q.axis], t.momentum_scale, 0};
}
double momentum_change(const QuantityHistory& now, const QuantityHistory& start) {
  return ratio(now[0] - start[0], start[1]);
}

QuantityHistory kept_angular_momentum(const Totals& t, const QuantitySpec&) {
  return {t.angular_momentum[0], t.angular_momentum[1], t.angular_momentum[2]};
}
double angular_momentum_change(const QuantityHistory& now, const QuantityHistory& start) {
  const Vec3 l(now[0], now[1], now[2]), l0(start[0], start[1], start[2]);
  return ratio((l - l0).norm(), l0.norm());
}

QuantityHistory kept_energy(const Totals& t, const QuantitySpec&) {
  return {t.energy, 0, 0};
}
double energy_change(const QuantityHistory& now, const QuantityHistory& start) {
  return ratio(now[0] - start[0], start[0]);
}

// ---- maxima ----

/// The maximum of value(simulation, spec, row) over bodies and steps from the spec's time on.
template <auto value>
constexpr Computation largest() {
  return {[](const Simulation& simulation, const QuantitySpec& q, QuantityHistory& h) {
            if (double(simulation.steps_done()) < q.time) return;
            for_bodies_of(simulation.bodies(), q,
                          [&](std::size_t row) { h[0] = std::max(h[0], value(simulation, q, row)); });
          },
          value_seen};
}

double speed(const Simulation& simulation, const QuantitySpec&, std::size_t row) {
  return simulation.bodies().velocity[row].norm();
}

double height(const Simulation& simulation, const QuantitySpec& q, std::size_t row) {
  return simulation.bodies().position[row][q.axis];
}

void observe_rebound(const Simulation& simulation, const QuantitySpec& q,
                     QuantityHistory& against_and_along) {
  const BodySet& bodies = simulation.bodies();
  for_bodies_of(bodies, q, [&](std::size_t row) {
    if (bodies.position[row][q.axis] < q.height) return;
    const double v = bodies.velocity[row][q.axis];
    against_and_along[0] = std::max(against_and_along[0], -v);
    against_and_along[1] = std::max(against_and_along[1], v);
  });
}

double rebound_ratio(const Simulation&, const QuantitySpec&, const QuantityHistory& against_and_along) {
  const double against = against_and_along[0], along = against_and_along[1];
  return against > 0 ? std::max(along, 0.0) / against : no_value;
}

std::array<double, 1> energy(const Simulation& simulation, const QuantitySpec& q, std::size_t row) {
  return {totals(simulation, q, row)[6]};
}

void keep_first_and_largest(const Case&, const QuantitySpec&, std::int64_t, std::span<const double> now,
                            QuantityHistory& energy) {
  if (energy[0] == not_yet) energy[0] = now[0];
  energy[1] = std::max(energy[1], now[0]);
}

double energy_growth(const Simulation&, const QuantitySpec&, const QuantityHistory& energy) {
  return energy[0] == not_yet ? no_value : ratio(energy[1] - energy[0], energy[0]);
}

// ---- rates of departure ----

/// Returns the change of `now` since the history's first number per step since its second.
double rate_since(const Simulation& simulation, const QuantityHistory& start, double now) {
  const double duration = double(simulation.steps_done()) - start[1];
  return start[0] == not_yet ? no_value : ratio(now - start[0], duration);
}

std::array<double, 1> mass_below(const Simulation& simulation, const QuantitySpec& q, std::size_t row) {
  const BodySet& bodies = simulation.bodies();
  return {bodies.position[row][q.axis] < q.height ? bodies.mass[row] : 0};
}

bool begins(const Simulation& simulation, const QuantitySpec& q, const QuantityHistory& start) {
  return start[0] == not_yet && double(simulation.steps_done()) >= q.time;
}

void keep_first_mass(const Case&, const QuantitySpec&, std::int64_t step, std::span<const double> mass,
                     QuantityHistory& start) {
  if (start[0] == not_yet) start = {mass[0], double(step), 0};
}

double discharge_rate(const Simulation& simulation, const QuantitySpec& q, const QuantityHistory& start) {
  const auto [now] = sums_over<1>(simulation.scene().comm, simulation.bodies(), q,
                                  [&](std::size_t row) { return mass_below(simulation, q, row); });
  return rate_since(simulation, start, now);
}

void observe_outflow(const Simulation& simulation, const QuantitySpec& q, QuantityHistory& start) {
  if (begins(simulation, q, start))
    start = {double(simulation.counters().left), double(simulation.steps_done())};
}

double outflow_rate(const Simulation& simulation, const QuantitySpec&, const QuantityHistory& start) {
  return rate_since(simulation, start, double(simulation.counters().left));
}

// ---- beds in round containers ----

/// Returns a body's mass times its position from the quantity's centre; if `weighing`, with the mass less
/// that of the displaced fluid, for free bodies only.
template <bool weighing>
Vec3 moment(const Simulation& simulation, const QuantitySpec& q, std::size_t row) {
  const BodySet& bodies = simulation.bodies();
  const double share = !weighing ? 1 : bodies.is_dynamic(row) ? bodies.weight_in_fluid[row] : 0;
  return bodies.mass[row] * share * (bodies.position[row] - q.centre);
}

/// Returns the angle about the axis between gravity and the line from the centre to the centre of mass of the
/// bodies: that of the surface if it is flat and the container round.
double bed_angle(const Case& setup, const QuantitySpec& q, std::int64_t step, std::span<const double> sums) {
  const Vec3 g = setup.gravity_at(double(step)), moment(sums[0], sums[1], sums[2]);
  const Vec3 axis = Vec3::Unit(q.axis), across = moment - moment.dot(axis) * axis;
  return rigid::elementary::atan2(axis.dot(g.cross(across)), g.dot(across)) * 180 / std::numbers::pi;
}

/// Returns the sum of r x (m g) along the axis.
double weight_torque(const Case& setup, const QuantitySpec& q, std::int64_t step,
                     std::span<const double> moment) {
  return Vec3(moment[0], moment[1], moment[2]).cross(setup.gravity_at(double(step)))[q.axis];
}

// ---- counts ----

double bodies_in_box(const Simulation& simulation, const QuantitySpec& q) {
  std::uint64_t inside = 0;
  for_bodies_of(simulation.bodies(), q,
                [&](std::size_t row) { inside += q.box.contains(simulation.bodies().position[row]); });
  return double(parallel::sum_over_ranks(simulation.scene().comm, inside));
}

double max_penetration(const Simulation& simulation) {
  return simulation.counters().penetration;
}

constexpr Quantity of_bodies[] = {
    {"drift", dimension::length, Q::body, Q::bodies, at_end<drift>(),
     "largest distance of one of the bodies from where it started, at the end"},
    {"displacement", dimension::length, Q::body | Q::axis, Q::bodies, at_end<displacement>(),
     "mean displacement along the axis since the start, counted across periodic borders"},
    {"momentum-change", dimension::none, Q::body | Q::axis, Q::bodies | Q::same_bodies,
     since_start<kept_momentum, momentum_change>(),
     "change of the free bodies' momentum since the start, over the sum of their |m v| then"},
    {"angular-momentum-change", dimension::none, Q::body, Q::bodies | Q::same_bodies,
     since_start<kept_angular_momentum, angular_momentum_change>(),
     "change of the free bodies' angular momentum about the domain's corner, over what it was"},
    {"energy-change", dimension::none, Q::body, Q::bodies | Q::same_bodies,
     since_start<kept_energy, energy_change>(),
     "kinetic and potential energy (zero at the domain's lowest corner) at the end over that at the start, "
     "less 1"},
    {"max-speed", dimension::velocity, Q::body, Q::bodies, largest<speed>(),
     "largest speed of any of the bodies in the run"},
    {"max-height-after", dimension::length, Q::body | Q::axis | Q::time, Q::bodies, largest<height>(),
     "largest coordinate of the bodies' centres along the axis from a time on"},
    {"rebound-ratio", dimension::none, Q::body | Q::axis | Q::height, Q::bodies,
     Computation{observe_rebound, rebound_ratio},
     "largest velocity along the axis over the largest against it, of bodies with their centres above the "
     "height"},
    {"energy-growth", dimension::none, Q::body, Q::bodies | Q::undriven | Q::same_bodies,
     Computation{nullptr, energy_growth, {1, add_over_bodies<energy>}, keep_first_and_largest},
     "largest energy of the run over that at the start, less 1"},
    {"discharge-rate", Dimension{0, -1, 1}, Q::body | Q::axis | Q::height | Q::time,
     Q::bodies | Q::same_bodies,
     Computation{nullptr, discharge_rate, {1, add_over_bodies<mass_below>, begins}, keep_first_mass},
     "mass that came below the height between the time and the end, per time"},
    {"outflow-rate", Dimension{0, -1, 0}, Q::time, Q::bodies, Computation{observe_outflow, outflow_rate},
     "number of bodies that left from a time on, per time"},
    {"bed-angle", dimension::none, Q::body | Q::axis | Q::centre, Q::bodies | Q::gravity,
     mean_of<bed_angle>({3, add_over_bodies<moment<false>>}),
     "angle in degrees about the axis from gravity to the line from `centre` to the centre of mass, mean "
     "from a time on: the slope of the bed in a round container",
     "degrees"},
    {"weight-torque", dimension::torque, Q::body | Q::axis | Q::centre, Q::bodies | Q::gravity,
     mean_of<weight_torque>({3, add_over_bodies<moment<true>>}),
     "torque about the axis through `centre` of the free bodies' weight less their buoyancy, mean from a "
     "time on"},
    {"body-count", dimension::none, Q::body | Q::box, Q::bodies, at_end<bodies_in_box>(),
     "number of bodies whose centre of mass lies in the box, at the end"},
    {"packing-fraction", dimension::none, Q::body | Q::box, Q::bodies, at_end<packing_fraction>(),
     "share of the box that lies inside the bodies, at the end"},
    {"max-penetration", dimension::length, 0, Q::bodies, at_end<max_penetration>(),
     "deepest overlap of any contact in the run"},
};

}  // namespace

constinit const std::span<const Quantity> body_quantities = of_bodies;

double mean_over_bodies(const Simulation& simulation, const QuantitySpec& q,
                        const std::function<double(std::size_t)>& value) {
  const auto [sum, count] =
      sums_over<2>(simulation.scene().comm, simulation.bodies(), q, [&](std::size_t row) {
        return std::array<double, 2>{value(row), 1.0};
      });
  return ratio(sum, count);
}

}  // namespace silt
