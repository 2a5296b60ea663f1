// Reads what drives bodies and fluid, also over time; estimates how fast they fall, rise or flow.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <tuple>

#include "rigid/shapes/shape.hpp"
#include "silt/case/case_check.hpp"
#include "silt/case/case_sections.hpp"

namespace silt {
namespace {

using rigid::Vec3;

using rigid::OverTime;
constexpr std::tuple over_time_keys{
    HandKey{"table", "[[time, share], …]", "s, 1", "1",
            "factors at given times, linear in between, constant before and after"},
    Key{"amplitude", &OverTime::amplitude, Number{},
        "of an oscillation that is added to the factor: amplitude × sin(2π frequency t)", nullptr,
        Rule{If::idle, is_zero(&OverTime::frequency), "the frequency is 0; give one"}},
    Key{"frequency", &OverTime::frequency, Number{dimension::angular_velocity, range::at_least(0)},
        "oscillations per unit of time: cycles, not radians", "with amplitude",
        Rule{If::idle, is_zero(&OverTime::amplitude), "the amplitude is 0; give one, or remove it"},
        Rule{If::needed, [](const OverTime& s) { return !is_zero(&OverTime::amplitude)(s); }}}};

constexpr double endless = std::numeric_limits<double>::infinity();
constexpr double least_exponent = 2.4;                     // of Richardson and Zaki, at high Reynolds numbers
constexpr double most_body_force = 0.1, most_gravity = 1;  // cells per step gained in a step
constexpr double most_metres = 500;                        // m/s2, except in a centrifuge

/// Returns the number from 0 to `high` from which on a test fails, by bisection.
template <class Test>
double last_for_which(Test&& holds, double high, int halvings) {
  double low = 0;
  for (int i = 0; i < halvings; ++i) {
    const double middle = (low + high) / 2;
    (holds(middle) ? low : high) = middle;
  }
  return low;
}

/// Free bodies of an entry, each as a sphere of equal volume; lattice units.
struct Fall {
  std::string entry;  // "bodies[2]", "fill[0]"
  double diameter, density, hindrance;
  double start = 0, height = 0;  // initial speed; largest fall height
  double square = endless;       // of the frequency of swinging on springs; 0: nothing holds it
};

/// Returns the speed that is reached: the terminal velocity with hindered settling, (1 - volume fraction)^2.4
/// at least (Richardson, Zaki 1954), or that of free fall with added mass to a wall or the run's end.
double speed_of(const Case& setup, const Fall& fall, double gravity) {
  const double steady =
      terminal_velocity(fall.diameter, fall.density, gravity, setup.fluid->kinematic_viscosity);
  const double gain = std::abs(fall.density - 1) / (fall.density + 0.5) * gravity;
  const double on_the_way = std::sqrt(fall.start * fall.start + 2 * gain * fall.height);
  const double in_time = fall.start + gain * static_cast<double>(setup.steps);
  const double swinging = fall.square > 0 ? fall.start + gain / std::sqrt(fall.square) : endless;
  return std::min({fall.hindrance * steady, on_the_way, in_time, swinging});
}

/// Returns the squared frequency of a body on springs to things that do not move.
double square_of_swing(const Case& setup, const BodySpec& body) {
  double square = 0;
  for (const coupler::SpringSpec& spring : setup.springs)
    for (const auto& [here, there, compliance] : {std::tuple(spring.body, spring.to, spring.compliance[0]),
                                                  std::tuple(spring.to, spring.body, spring.compliance[1])})
      if (here > 0 && &setup.bodies[here - 1] == &body &&
          (there == 0 || setup.bodies[there - 1].motion != rigid::Motion::free))
        square += spring.stiffness * compliance;
  return square;
}

/// Returns whether gravity cannot move a body: it is not free, or is locked along gravity.
bool stands(const Case& setup, const BodySpec& body) {
  return body.motion != rigid::Motion::free || rigid::without_locked(body.locked, setup.gravity).isZero(0);
}

/// Returns the distance from a point to the first side along a direction.
double way_to_a_side(const Case& setup, const Vec3& x, const Vec3& direction) {
  double way = endless;
  for (int d = 0; d < 3; ++d)
    if (!setup.periodic(d) && direction[d] != 0)
      way = std::min(way, ((direction[d] > 0 ? setup.cells[d] : 0) - x[d]) / direction[d]);
  return std::max(0., way);
}

/// Returns the falls of all entries of free bodies with weight in the fluid; needs fluid and gravity.
std::vector<Fall> expected_falls(const Case& setup) {
  double volume = 0;
  for (const Entry& entry : entries_of(setup))
    volume += static_cast<double>(entry.count) * rigid::mass_properties(setup.shapes[entry.shape]).volume;
  const double hindrance = std::pow(1 - std::clamp(volume / setup.volume(), 0., 0.6), least_exponent);
  const auto down = [&](double density) -> Vec3 {
    return (density > 1 ? 1 : -1) * setup.gravity.normalized();
  };
  std::vector<Fall> falls;
  const auto add = [&](const std::string& entry, int shape, double density, double start, double height,
                       double square) {
    if (falls.empty() || falls.back().entry != entry)
      falls.push_back({entry, sphere_of_volume(setup.shapes[shape]), density, hindrance});
    falls.back().square = std::min(falls.back().square, square);
    falls.back().start = std::max(falls.back().start, start);
    falls.back().height = std::max(falls.back().height, height);
  };
  setup.for_each_given([&](const BodySpec& body, std::uint64_t) {
    if (stands(setup, body) || body.density == 1) return;
    const double height =
        body.point > 0 ? endless : way_to_a_side(setup, body.pose.position, down(body.density));
    add(entry_key(body.entry), body.shape, body.density, body.velocity.norm(), height,
        square_of_swing(setup, body));
  });
  for (std::size_t i = 0; i < setup.fills.size(); ++i) {
    const FillSpec& fill = setup.fills[i];
    if (fill.density == 1) continue;
    const Vec3 along = down(fill.density);
    const Vec3 furthest = (along.array() > 0).select(fill.box.lower, fill.box.upper);
    add(fmt::format("fill[{}]", i), fill.shape, fill.density, fill.velocity.norm(),
        way_to_a_side(setup, furthest, along), 0);
  }
  return falls;
}

void check_gain(const Case& setup, Diagnostics& findings, const char* key, double gained, double most) {
  if (!(gained > most)) return;
  const std::string cure = units_first(setup, time_step_cure(setup, std::sqrt(most / gained)));
  findings.error(
      key, "{} adds {} cells a step to a velocity in every step; at most {} is possible: {}or lower it to {}",
      key, shown(gained), shown(most), cure.empty() ? "shorten the time step, " : cure + ", ",
      shown(setup.units.physical(most, dimension::acceleration)));
}

void check_gravity(const Case& setup, Diagnostics& findings) {
  constexpr const char* key = "gravity.acceleration";
  const double most = setup.gravity_over_time.most(), gained = most * setup.gravity.cwiseAbs().maxCoeff();
  const double gravity = most * setup.units.physical(setup.gravity.norm(), dimension::acceleration);
  const std::string slip = gravity_slip(setup);
  const std::string text = fmt::format("{} is {} m/s2; that of the Earth is 9.81, which is 9810 mm/s2{}{}",
                                       key, shown(gravity), slip.empty() ? "" : ": ", slip);
  if (slip.empty()) check_gain(setup, findings, key, gained, most_gravity);
  if (!slip.empty() && gained > most_gravity)
    findings.error(key,
                   "{}; now it adds {} cells a step to a velocity in every step, and at most {} is possible",
                   text, shown(gained), most_gravity);
  else if (setup.units.si && gravity > most_metres)
    findings.warning(key, "{}", text);
  const bool all_periodic =
      setup.periodic(0) && setup.periodic(1) && setup.periodic(2) && setup.walls.empty();
  const bool held =
      setup.any_given([&](const BodySpec& b) { return stands(setup, b); }) ||
      std::ranges::any_of(setup.springs, [](const coupler::SpringSpec& spring) { return spring.to == 0; });
  const bool balanced = setup.fluid && setup.fluid->has_body_force();
  const bool any_weight =
      !setup.continued.empty() || std::ranges::any_of(entries_of(setup), [&](const Entry& entry) {
        return !setup.fluid || entry.density != 1;
      });
  if (any_weight && gravity > 0 && all_periodic && !held && !balanced)
    findings.warning(key,
                     "gravity acts, but nothing holds the fluid and the bodies: a domain that is periodic "
                     "all round accelerates for ever; fluid.body_force can balance their weight");
}

/// Warns of bodies heavier or lighter than the fluid where nothing causes motion.
void check_weight(const Case& setup, Diagnostics& findings) {
  const coupler::FluidSpec& fluid = *setup.fluid;
  const std::vector<Entry> entries = entries_of(setup);
  if (setup.places.count("gravity.acceleration") || fluid.has_body_force() || fluid.initial.noise > 0 ||
      fastest_given(setup) > 0 || std::ranges::any_of(entries, &Entry::moves) ||
      std::ranges::any_of(setup.boundary,
                          [](const coupler::BoundarySpec& side) { return side.pressure != 0; }) ||
      std::ranges::any_of(setup.walls, &CurvedWall::moves) || !setup.kind_motions.empty() ||
      !setup.springs.empty() || setup.start ||
      std::ranges::any_of(setup.pair_materials, &rigid::Material::pulls))
    return;
  const auto heavy =
      std::ranges::find_if(entries, [](const Entry& entry) { return entry.is_free() && entry.density != 1; });
  if (heavy != entries.end())
    findings.warning(heavy->key + ".density",
                     "{} is heavier or lighter than the fluid, but there is no [gravity] and nothing else "
                     "moves: all stays at rest; give gravity.acceleration = [0, 0, {}]",
                     heavy->key, setup.units.si ? "-9.81" : "-1e-4");
}

void check_fall(const Case& setup, Diagnostics& findings, const Fall& fall) {
  const double gravity = setup.gravity.norm(), speed = speed_of(setup, fall, gravity);
  const std::string key = fall.entry + ".density";
  const std::string found =
      fmt::format("{} comes to {} cells a step{} as it {} (a sphere of its volume)", fall.entry, shown(speed),
                  in_si(setup, speed), fall.density > 1 ? "falls" : "rises");
  if (const std::string doubt = doubt_of_heat(setup, speed); !doubt.empty())
    findings.warning(key, "{}, {}", found, doubt);
  if (!(speed > doubtful_velocity * (1 + unseen))) return;
  const auto is_slow = [&](double share) {
    return speed_of(setup, fall, share * gravity) <= doubtful_velocity;
  };
  const std::string slip = density_slip(setup, key, setup.units.physical(fall.density, dimension::density));
  // shorter steps, or (in lattice units) less gravity
  const std::string cure = setup.units.si ? (slip.empty() ? "" : slip + "; else ") +
                                                time_step_cure(setup, doubtful_velocity / speed)
                                          : fmt::format("use {} times as much gravity.acceleration",
                                                        shown(rounded_down(last_for_which(is_slow, 1, 60))));
  if (speed > impossible_velocity)
    findings.error(key, "{}; at most {} is possible: {}", found, impossible_velocity,
                   units_first(setup, cure));
  else
    findings.warning(key, "{}; above {} the fluid is noticeably compressible: {}", found, doubtful_velocity,
                     units_first(setup, cure));
}

/// Returns the largest velocity of laminar flow under the body force, between walls across it or else at the
/// end of the run; lattice units.
double laminar_speed(const Case& setup) {
  const Vec3 given = setup.fluid->body_force_over_time.most() * setup.fluid->body_force;
  const Vec3 force = (setup.fluid->superficial_velocity.array() != 0).select(0, given);  // else controlled
  const double nu = setup.fluid->kinematic_viscosity;
  double speed = force.norm() * static_cast<double>(setup.steps);
  for (int d = 0; d < 3; ++d) {
    if (setup.periodic(d)) continue;
    Vec3 along = force;
    along[d] = 0;
    speed = std::min(speed, along.norm() * setup.cells[d] * setup.cells[d] / (8 * nu));
  }
  for (const CurvedWall& wall : setup.walls)
    if (const rigid::TubeWallSpec* tube = wall.tube())
      speed = std::min(speed, force.norm() * tube->tube.radius * tube->tube.radius / (4 * nu));
  return speed;
}

void check_flow(const Case& setup, Diagnostics& findings) {
  const auto meshes = [](const CurvedWall& wall) { return wall.mesh() != nullptr; };
  if (setup.has_bodies() || std::ranges::any_of(setup.walls, meshes)) return;
  const double speed = laminar_speed(setup);
  if (!(speed > doubtful_velocity * (1 + unseen))) return;
  const double factor = doubtful_velocity / speed;
  findings.warning(
      "fluid.body_force",
      "fluid.body_force drives laminar flow at up to {} cells a step{}; above {} the fluid is "
      "noticeably compressible: {}",
      shown(speed), in_si(setup, speed), doubtful_velocity,
      units_first(setup, setup.units.si ? time_step_cure(setup, factor)
                                        : fmt::format("use {} times as much", shown(rounded_down(factor)))));
}

/// Warns where free bodies do not feel the force that drives the fluid and the case does not say so.
void check_push(const Case& setup, Diagnostics& findings) {
  constexpr const char* key = "fluid.body_force_on_bodies";
  if (!setup.fluid->has_body_force() || !setup.has_free_bodies() || setup.places.count(key)) return;
  findings.warning(
      setup.places.count("fluid.body_force") ? "fluid.body_force" : "fluid.superficial_velocity",
      "free bodies do not feel the body force that drives the fluid; as a pressure gradient, or as the "
      "weight of the fluid along a slope, it acts on them, too: use {} = true (or false, if they are not "
      "to feel it)",
      key);
}

/// Returns the least distance between sides or walls of a tube; infinite without them.
double narrowest(const Case& setup) {
  double width = endless;
  for (int d = 0; d < 3; ++d)
    if (!setup.periodic(d)) width = std::min(width, double(setup.cells[d]));
  for (const CurvedWall& wall : setup.walls)
    if (const rigid::TubeWallSpec* tube = wall.tube()) width = std::min(width, 2 * tube->tube.radius);
  return width;
}

/// Returns the largest speed that is given to the fluid, or that it has in laminar flow; lattice units.
double speed_of_stream(const Case& setup) {
  const coupler::FluidSpec& fluid = *setup.fluid;
  double speed =
      std::max({fluid.initial.largest_speed(), fluid.superficial_velocity.norm(), laminar_speed(setup)});
  for (const coupler::BoundarySpec& side : setup.boundary) speed = std::max(speed, side.largest_speed());
  return speed;
}

/// Warns of bodies that inertial lift carries across a stream, for which the galilean form is wrong.
void check_lift(const Case& setup, Diagnostics& findings) {
  constexpr const char* key = "coupling.force";
  constexpr double least_reynolds = 0.5, slow = 0.01;  // of u d^2 / (nu H); of the speed
  if (setup.coupling.force == coupler::ForceForm::exact || setup.places.count(key)) return;
  const double nu = setup.fluid->kinematic_viscosity, speed = speed_of_stream(setup);
  const auto is_lifted = [&](const Entry& entry) {
    const double diameter = sphere_of_volume(setup.shapes[entry.shape]);
    return entry.is_free() && speed * diameter * diameter > least_reynolds * nu * narrowest(setup) &&
           terminal_velocity(diameter, entry.density, setup.gravity.norm(), nu) < slow * speed;
  };
  for (const std::vector<Entry>& entries : {entries_of(setup), continued_entries_of(setup)})
    if (const auto found = std::ranges::find_if(entries, is_lifted); found != entries.end())
      findings.warning(found->key,
                       "{} hardly falls or rises, so that lift decides where in the stream it goes, and {} = "
                       "\"galilean\" carries it too near to a wall: use \"exact\"",
                       found->key, key);
}

/// Checks that a prescribed mean velocity is low enough and along periodic axes.
void check_control(const Case& setup, Diagnostics& findings) {
  constexpr const char* key = "fluid.superficial_velocity";
  const Vec3& wanted = setup.fluid->superficial_velocity;
  check_speed(findings, key, wanted.norm());
  for (int d = 0; d < 3; ++d)
    if (wanted[d] != 0 && !setup.periodic(d))
      findings.error(key,
                     "{}[{}] is {}, but {} is not periodic, and no body force drives a flow through it; give "
                     "a velocity-inlet there, or 0",
                     key, d, shown(setup.units.physical(wanted[d], dimension::velocity)), "xyz"[d]);
}

/// Rejects a drive that varies with [coarsening]: lists at borders of levels contain its values.
void check_over_time(const Case& setup, Diagnostics& findings) {
  const auto refuse = [&](const std::string& key, bool changes) {
    if (changes && setup.coarsening)
      findings.error(
          key,
          "{} makes what drives the fluid change over time, but [coarsening] is given; remove one of them",
          key);
  };
  refuse("fluid.superficial_velocity", !setup.fluid->superficial_velocity.isZero(0));
  refuse("fluid.body_force_over_time", setup.fluid->body_force_over_time.varies());
  for (int side = 0; side < 6; ++side)
    refuse(fmt::format("{}.over_time", side_key(side)), setup.boundary[side].over_time.varies());
}

}  // namespace

KeySection over_time_section() {
  return section_of("gravity.over_time", over_time_keys);
}

OverTime read_over_time(TableReader& parent, const char* key) {
  OverTime over_time;
  TableReader table = parent.table(key);
  if (!table.present()) return over_time;
  read_keys(table, over_time, over_time_keys);
  const Node* list = table.find("table");
  if (!list) return over_time;
  const double step = table.context().units.time_step;
  for (const Node& row : list->children) {
    const auto numbers = row.numbers(2);
    if (!numbers || (!over_time.table.empty() && !((*numbers)[0] / step > over_time.table.back().time)))
      break;
    over_time.table.push_back({(*numbers)[0] / step, (*numbers)[1]});
  }
  if (over_time.table.empty() || over_time.table.size() != list->children.size())
    table.refuse("table", "a list of pairs, [[time, share], ...], in ascending order of times");
  return over_time;
}

double sphere_of_volume(const rigid::Shape& shape) {
  return std::cbrt(6 / std::numbers::pi * rigid::mass_properties(shape).volume);
}

double terminal_velocity(double diameter, double density, double gravity, double nu) {
  const double buoyancy = 4. / 3 * std::abs(density - 1) * gravity * diameter;  // u^2 C_D
  const auto is_slow = [&](double u) {
    const double reynolds = u * diameter / nu;
    return 24 * nu / diameter * u * (1 + 0.15 * std::pow(reynolds, 0.687)) < buoyancy;
  };
  return last_for_which(is_slow, buoyancy * diameter / (24 * nu), 100);  // Stokes' law as an upper bound
}

void find_driving_faults(const Case& setup, Diagnostics& findings) {
  check_gravity(setup, findings);
  if (!setup.fluid) return;
  check_gain(setup, findings, "fluid.body_force",
             setup.fluid->body_force_over_time.most() * setup.fluid->body_force.cwiseAbs().maxCoeff(),
             most_body_force);
  check_control(setup, findings);
  check_over_time(setup, findings);
  check_weight(setup, findings);
  check_flow(setup, findings);
  check_push(setup, findings);
  check_lift(setup, findings);
  if (setup.gravity.norm() == 0) return;
  for (const Fall& fall : expected_falls(setup)) check_fall(setup, findings, fall);
}

}  // namespace silt
