#include "silt/case/case_check.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "silt/case/case.hpp"
#include "silt/case/case_sections.hpp"

namespace silt {

std::string body_name(const Case& setup, rigid::BodyId id) {
  if (!rigid::is_wall(id)) return fmt::format("body {}", id);
  if (id < rigid::first_tube_id)
    return fmt::format("the side {}", coupler::side_names[coupler::Side(id - rigid::first_wall_id)]);
  return fmt::format("the wall '{}'", setup.walls[id - rigid::first_tube_id].name);
}

std::string entry_key(int entry) {
  return fmt::format("bodies[{}]", entry);
}

std::string position_key(const Case& setup, int entry) {
  const std::string key = entry_key(entry);
  return key + (setup.places.count(key + ".positions") ? ".positions" : ".position");
}

std::string position_text(const Case& setup, const BodySpec& body) {
  const std::string key = position_key(setup, body.entry);
  if (body.point == 0) return key;
  const auto filed =
      std::ranges::find_if(setup.filed, [&](const FiledBodies& f) { return f.alike.entry == body.entry; });
  return fmt::format("{}, point {} of {}", key, body.point, filed->positions.name());
}

std::string shown(const rigid::Vec3& x) {
  return fmt::format("[{}, {}, {}]", shown(x[0]), shown(x[1]), shown(x[2]));
}

std::string shown_point(const Case& setup, const rigid::Vec3& x) {
  return shown(rigid::Vec3(x * setup.units.cell_size));
}

std::string shown_box(const Case& setup, const rigid::BoundingBox& box) {
  return fmt::format("{} to {}", shown_point(setup, box.lower), shown_point(setup, box.upper));
}

bool lies_in_domain(const Case& setup, const rigid::BoundingBox& box, double slack) {
  const rigid::Vec3 margin = rigid::Vec3::Constant(slack);
  const rigid::BoundingBox domain = box_of(setup), wider{domain.lower - margin, domain.upper + margin};
  return wider.contains(box.lower) && wider.contains(box.upper);
}

std::string shown_length(const Case& setup, double x) {
  return shown(x * setup.units.cell_size);
}

void Diagnostics::idle(const std::string& key, std::string_view why) {
  if (setup.places.count(key)) warning(key, "{} has no effect: {}", key, why);
}

void Diagnostics::add(Diagnostic::Severity severity, const std::string& key, const std::string& text) {
  list.push_back({severity, setup.place(key), text});
}

namespace {

// A body that moves further in a sub-step than contacts look ahead may be found only when it overlaps
// another; one that moves much further may be missed.
void check_margin(const Case& setup, Diagnostics& findings, const std::string& key, double speed, int shape) {
  const double step = speed / setup.contacts.substeps, limit = MotionLimits(setup).of(shape);
  if (!setup.fluid && !(speed <= limit))
    findings.error(key,
                   "{}: the body moves {} cells in a step; beyond {} it may pass through others: raise "
                   "contacts.substeps to {:.0f}{}",
                   key, shown(speed), shown(limit), std::ceil(speed / limit * setup.contacts.substeps),
                   setup.units.si ? ", or " + time_step_cure(setup, limit / speed) : "");
  else if (step > setup.contacts.margin)
    findings.warning(key,
                     "{}: the body moves {} cells in a sub-step, but contacts.margin is {}: it may overlap "
                     "others; raise contacts.margin or contacts.substeps",
                     key, shown(step), shown(setup.contacts.margin));
}

void check_speeds(const Case& setup, Diagnostics& findings) {
  const auto check_motion = [&](const Entry& entry) {
    if (const auto found = setup.kind_motions.find(entry.kind);
        setup.fluid && found != setup.kind_motions.end() && entry.motion == rigid::Motion::prescribed)
      check_speed(findings, entry.key + ".motion",
                  found->second.speed_bound(rigid::bounding_radius(setup.shapes[entry.shape])));
  };
  for (const Entry& entry : entries_of(setup)) {
    check_velocities(findings, entry.key + ".", entry.shape, entry.velocity, entry.angular_velocity);
    check_motion(entry);
  }
  for (const Entry& entry : continued_entries_of(setup)) check_motion(entry);
}

constexpr double digit_rounding = 1e-9;  // relative to two digits

double second_digit(double x) {
  return std::pow(10, std::floor(std::log10(x)) - 1);
}

/// Returns the key by which a case sets the time step.
std::string time_step_key(const Case& setup) {
  for (const char* key : {"units.relaxation_time", "units.max_velocity"})
    if (setup.places.count(key)) return key;
  return "units.time_step";
}

constexpr double without_limit = std::numeric_limits<double>::infinity();

double width_of_thinnest_part(const rigid::Shape& shape) {
  double width = without_limit;
  for (const rigid::Part& part : rigid::convex_parts(shape))
    width = std::min(width, std::visit([](const auto& s) { return s.least_width(); }, part.shape));
  return width;
}

}  // namespace

std::vector<Diagnostic> check_case(const Case& setup) {
  Diagnostics findings(setup);
  findings.list = setup.warnings;
  find_domain_faults(setup, findings);
  find_fluid_faults(setup, findings);
  find_heat_faults(setup, findings);
  find_contact_faults(setup, findings);
  find_run_faults(setup, findings);
  find_density_faults(setup, findings);
  find_quantity_faults(setup, findings);
  check_speeds(setup, findings);
  find_wall_faults(setup, findings);
  find_body_faults(setup, findings);
  find_turnover_faults(setup, findings);
  find_driving_faults(setup, findings);
  find_spring_faults(setup, findings);
  find_coarsening_faults(setup, findings);
  find_idle_sections(setup, findings);
  return std::move(findings.list);
}

std::vector<Diagnostic> require_runnable(const Case& setup) {
  std::vector<Diagnostic> list = check_case(setup);
  if (!has_errors(list)) return list;
  std::erase_if(list, [](const Diagnostic& d) { return d.severity == Diagnostic::Severity::warning; });
  throw CaseError(std::move(list));
}

double rounded_down(double x) {
  return std::floor(x / second_digit(x) + digit_rounding) * second_digit(x);
}

double rounded_up(double x) {
  return std::ceil(x / second_digit(x) - digit_rounding) * second_digit(x);
}

std::string time_step_cure(const Case& setup, double factor) {
  if (!setup.units.si) return "";
  const std::string key = time_step_key(setup);
  const double old = setup.units.time_step, excess = setup.fluid ? setup.fluid->relaxation_time - 0.5 : 0;
  if (key == "units.relaxation_time")
    return fmt::format("use {} = {:.12g}", key, 0.5 + rounded_down(factor * excess));
  const double step = rounded_down(factor * old);
  constexpr double target = 0.05;  // cells per step, that of units.max_velocity
  const double value = key == "units.max_velocity" ? rounded_up(target * setup.units.cell_size / step) : step;
  constexpr double small = 1e-3;  // three digits of the sum do not show it
  const double then = excess * step / old;
  const std::string tau =
      then < small ? fmt::format("0.5 + {:.2g}", then) : fmt::format("{:.3g}", 0.5 + then);
  const bool follows = setup.fluid && gives_viscosity(setup);
  return fmt::format("use {} = {}{}", key, shown(value),
                     follows ? fmt::format(" (relaxation time {})", tau) : "");
}

std::string shorter_step(const Case& setup) {
  if (!setup.units.si) return "";
  const std::string key = time_step_key(setup);
  return fmt::format("a {} {}", key == "units.max_velocity" ? "larger" : "smaller", key);
}

std::string longer_step(const Case& setup) {
  if (!setup.units.si) return "a longer time step";
  const std::string key = time_step_key(setup);
  return fmt::format("a {} {}", key == "units.max_velocity" ? "smaller" : "larger", key);
}

std::string in_si(const Case& setup, double x, Dimension d) {
  if (!setup.units.si) return "";
  return fmt::format(" ({} {})", shown(setup.units.physical(x, d)), setup.units.unit_text(d));
}

void check_speed(Diagnostics& findings, const std::string& key, double speed) {
  if (speed <= doubtful_velocity * (1 + unseen)) return;
  const Case& setup = findings.setup;
  const std::string found = fmt::format("{} is {} cells a step{}", key, shown(speed), in_si(setup, speed));
  std::string cure = fmt::format("lower it to {}", doubtful_velocity);
  if (setup.units.si)
    cure = units_first(setup, time_step_cure(setup, doubtful_velocity / speed)) +
           (motion_slip(setup).empty() ? ", or lower it" : ", and velocities in m/s");
  if (!(speed <= impossible_velocity))
    findings.error(key, "{}; it must be at most {}: {}", found, impossible_velocity, cure);
  else
    findings.warning(key, "{}; above {} the fluid is noticeably compressible: {}", found, doubtful_velocity,
                     cure);
}

void check_velocities(Diagnostics& findings, const std::string& entry, int shape, const rigid::Vec3& velocity,
                      const rigid::Vec3& angular_velocity) {
  const Case& setup = findings.setup;
  const double speed = velocity.norm(), turn = angular_velocity.norm();
  check_margin(setup, findings, entry + "velocity", speed, shape);
  if (setup.fluid) {
    check_speed(findings, entry + "velocity", speed);
    if (turn > 0)
      check_speed(findings, entry + "angular_velocity", rigid::bounding_radius(setup.shapes[shape]) * turn);
  } else if (!(turn <= std::numbers::pi)) {
    findings.error(
        entry + "angular_velocity",
        "{}angular_velocity turns the body by {} degrees in a step; at most 180 are possible: lower it{}",
        entry, shown(turn * 180 / std::numbers::pi),
        setup.units.si ? ", or " + time_step_cure(setup, std::numbers::pi / turn) : "");
  }
}

MotionLimits::MotionLimits(const Case& setup) : least_(without_limit), least_half_width_(without_limit) {
  const ContactSpec& contacts = setup.contacts;
  for (const rigid::Shape& shape : setup.shapes) {
    const double width = width_of_thinnest_part(shape);
    of_shape_.push_back(setup.fluid ? furthest_motion : contacts.substeps * 0.5 * (contacts.margin + width));
    half_width_.push_back(0.5 * width);
    least_ = std::min(least_, of_shape_.back());
    least_half_width_ = std::min(least_half_width_, half_width_.back());
  }
}

double least_explicit_density(const Case& setup, const rigid::Shape& shape) {
  if (!setup.fluid || setup.coupling.time != coupler::TimeCoupling::explicit_) return 0;
  const bool steps = setup.coupling.wall_scheme == coupler::WallScheme::bounce_back;
  const double stiffness = steps ? 4.7 : 5.13, bearable = steps ? 0.80 : 0.40;
  return stiffness / (rigid::least_width(shape) * bearable * std::sqrt(setup.fluid->relaxation_time - 0.5));
}

bool has_bodies_too_light(const Case& setup) {
  const std::vector<Entry> entries = entries_of(setup);
  return std::ranges::any_of(entries, [&](const Entry& entry) {
    return entry.is_free() && entry.density < least_explicit_density(setup, setup.shapes[entry.shape]);
  });
}

namespace {

constexpr double cubic_centimetres = 1000;                // kg/m3 in g/cm3
constexpr double of_the_earth = 9.81;                     // m/s2
constexpr double least_excess = 1e-3, most_excess = 1.5;  // of tau - 1/2 in sound runs

bool is_of_the_earth(double gravity) {
  return std::abs(gravity / of_the_earth - 1) < 0.02;
}

bool is_of_a_fluid(double viscosity) {
  return viscosity >= thinnest && viscosity <= thickest;
}

double gravity_of(const Case& setup) {
  return setup.units.physical(setup.gravity.norm(), dimension::acceleration);
}

/// A unit of length.
struct SmallLength {
  const char* name;
  double in_a_metre;
};

/// Returns the unit in which gravity would be that of the Earth, else millimetres.
SmallLength small_length(const Case& setup) {
  constexpr SmallLength centimetres{"cm", 100}, millimetres{"mm", 1000};
  return is_of_the_earth(gravity_of(setup) / centimetres.in_a_metre) ? centimetres : millimetres;
}

}  // namespace

std::string viscosity_slip(const Case& setup) {
  constexpr const char* key = "fluid.kinematic_viscosity";
  if (!setup.units.si || !setup.places.count(key)) return "";
  const SmallLength small = small_length(setup);
  const double found = setup.units.physical(setup.fluid->kinematic_viscosity, dimension::viscosity);
  const double meant = found / (small.in_a_metre * small.in_a_metre);
  if (!(found > thickest && is_of_a_fluid(meant))) return "";
  const bool long_cells = !setup.places.count("units.relaxation_time") &&
                          (setup.fluid->relaxation_time - 0.5) * meant / found < least_excess;
  return fmt::format("if {} is in {}2/s, write {} (m2/s){}", key, small.name, shown(meant),
                     long_cells ? ", and lengths in m" : "");
}

std::string gravity_slip(const Case& setup) {
  const SmallLength small = small_length(setup);
  const double meant = gravity_of(setup) / small.in_a_metre;
  if (!setup.units.si || !is_of_the_earth(meant)) return "";
  return fmt::format("if gravity.acceleration is in {}/s2, write {} (m/s2)", small.name, shown(meant));
}

std::string motion_slip(const Case& setup) {
  const std::string viscosity = viscosity_slip(setup), gravity = gravity_slip(setup);
  return viscosity + (viscosity.empty() || gravity.empty() ? "" : ", and ") + gravity;
}

std::string length_slip(const Case& setup) {
  constexpr double millimetres = 1000, long_cell = 0.05;  // in a metre; m
  if (!setup.units.si || !setup.fluid) return "";
  const double excess = (setup.fluid->relaxation_time - 0.5) * millimetres * millimetres;
  if ((excess < least_excess || excess > most_excess) && setup.units.cell_size < long_cell) return "";
  return fmt::format("if lengths are in mm, write them in m (units.cell_size = {})",
                     shown(setup.units.cell_size / millimetres));
}

std::string size_slip(const Case& setup) {
  constexpr double millimetres = 1000;  // in a metre
  const rigid::Vec3 meant = setup.units.cell_size / millimetres * extent_of(setup).size;
  if (!setup.units.si || !(meant.minCoeff() > setup.units.cell_size)) return "";
  return fmt::format("if domain.size is in mm, write {} (m); else ", shown(meant));
}

std::string units_first(const Case& setup, const std::string& cure) {
  const std::string slip = motion_slip(setup), lengths = length_slip(setup);
  if (!slip.empty()) return slip;
  return lengths.empty() ? cure : lengths + "; else " + cure;
}

std::string scale_slip(const Case& setup, const std::string& entry, double across) {
  constexpr double far = 100;  // times the domain: in millimetres one of a tenth of its length is so large
  const double times = across / *std::ranges::max_element(setup.cells);
  if (times < far) return "";
  return fmt::format(
      "{}.file is {} across, {:.0f} times the domain: correct {}.scale, the unit of length of the file in "
      "that of the case{}",
      entry, shown_length(setup, across), times, entry, setup.units.si ? " (0.001 for millimetres)" : "");
}

std::string density_slip(const Case& setup, const std::string& key, double density) {
  const auto in = [](const char* unit, const std::string& keys, const std::string& numbers) {
    return fmt::format("if {} in {}, write {} (kg/m3)", keys, unit, numbers);
  };
  const double body_meant = cubic_centimetres * density,
               fluid_meant = cubic_centimetres * setup.units.density;
  const bool fluid = setup.fluid && is_of_a_solid(fluid_meant), solid = is_of_a_solid(density);
  if (!setup.units.si) return "";
  if (!solid && is_of_a_solid(body_meant) && fluid)
    return in("g/cm3", fmt::format("fluid.density and {} are", key),
              fmt::format("{} and {}", shown(fluid_meant), shown(body_meant)));
  if (!solid && is_of_a_solid(body_meant)) return in("g/cm3", key + " is", shown(body_meant));
  if (solid && fluid) return in("g/cm3", "fluid.density is", shown(fluid_meant));
  const double in_kilograms = density / 1000;
  return !solid && is_of_a_solid(in_kilograms) ? in("g/m3", key + " is", shown(in_kilograms)) : "";
}

}  // namespace silt
