// [fluid], [coupling] and [gravity], with their checks, and the choice of a stable collision model.
#include <fmt/format.h>

#include <algorithm>

#include "silt/case/case.hpp"
#include "silt/case/case_check.hpp"
#include "silt/case/case_sections.hpp"

namespace silt {

double measured_reynolds(lbm::Collision model) {
  return lbm::model_of(model).lasts_to;
}

void choose_collision(Case& setup) {
  if (!setup.fluid || !setup.fluid->collision_by_scene) return;
  const bool fast = cell_reynolds(setup) > measured_reynolds(lbm::Collision::trt);
  setup.fluid->collision = fast ? lbm::Collision::regularised : lbm::Collision::trt;
}

const char* viscosity_key(const Case& setup) {
  for (const char* key : {"fluid.kinematic_viscosity", "fluid.dynamic_viscosity"})
    if (setup.places.count(key)) return key;
  return "fluid.relaxation_time";
}

bool gives_viscosity(const Case& setup) {
  return std::string_view(viscosity_key(setup)) != "fluid.relaxation_time";
}

std::string collision_reason(const Case& setup) {
  if (!setup.fluid->collision_by_scene) return "given";
  return fmt::format("auto: u/nu = {}, trt lasts to {}", shown(cell_reynolds(setup)),
                     shown(measured_reynolds(lbm::Collision::trt)));
}

namespace {

constexpr Range possible_magic{0, 1e3, false, true};
bool pushes_no_bodies(const Case& setup) {
  const coupler::FluidSpec& fluid = *setup.fluid;
  return fluid.body_force_on_bodies && fluid.has_body_force() && !setup.has_free_bodies();
}
bool is_quiet_in_vain(const Case& setup) {
  return setup.fluid->quiet_start && quiet_start_steps(setup) == 0;
}
/// A controlled flow rate uses the body force along its axes.
constexpr auto is_controlled_along_the_force = [](const coupler::FluidSpec& fluid) {
  const auto given = fluid.body_force.array() != 0, controlled = fluid.superficial_velocity.array() != 0;
  return given.any() && !(given && !controlled).any();
};
constexpr std::tuple fluid_keys{
    HandKey{"density", "number", "kg/m³", "– (si), 1", "reference density"},
    Key{"kinematic_viscosity", &coupler::FluidSpec::kinematic_viscosity,
        Number{dimension::viscosity, range::above(0)}, "kinematic viscosity ν", "one of three"},
    Key{"dynamic_viscosity", &coupler::FluidSpec::kinematic_viscosity,  // the fluid's density is 1
        Number{dimension::dynamic_viscosity, range::above(0)}, "dynamic viscosity μ = ν × density",
        "one of three"},
    Key{"relaxation_time", &coupler::FluidSpec::relaxation_time, Number{},
        "relaxation time τ = 1/2 + 3 ν in lattice units", "one of three"},
    HandKey{"collision", "\"trt\", \"bgk\", \"regularised\", \"auto\"", "", "\"trt\"",
            "collision model: two relaxation times, one, or for high cell Reynolds numbers; \"auto\": "
            "\"trt\" if it is stable at the largest given speed"},
    Key{"magic", &coupler::FluidSpec::magic, Number{dimension::none, possible_magic},
        "Λ = (τ − 1/2)(τ_odd − 1/2) of trt; with bodies or [[walls]] by default 1/16 under \"parabolic\", "
        "2/15 under \"multireflection\" (up to 1/6 below τ = 0.77)",
        "1/6"},
    Key{"precision", &coupler::FluidSpec::precision, Choice{coupler::precision_names},
        "precision of the stored populations"},
    Key{"body_force", &coupler::FluidSpec::body_force, Vector{dimension::acceleration},
        "acceleration of the fluid"},
    HandKey{"body_force_over_time", "table", "", "steady", "how it changes: see gravity.over_time",
            Rule{If::idle, is_zero(&coupler::FluidSpec::body_force),
                 "there is no body_force that it could change; remove it"},
            Rule{If::idle, is_controlled_along_the_force,
                 "superficial_velocity controls the body force along the same axes; remove one of them"}},
    Key{"superficial_velocity", &coupler::FluidSpec::superficial_velocity, Vector{dimension::velocity},
        "mean velocity over all cells (0 in bodies) to which the body force is controlled, along the axes "
        "where it is not 0"},
    Key{"body_force_on_bodies", &coupler::FluidSpec::body_force_on_bodies, Flag{},
        "true where the body force stands for a pressure gradient, or for the weight of the fluid along a "
        "slope: free bodies feel the force on the fluid they displace",
        nullptr,
        Rule{If::idle,
             [](const coupler::FluidSpec& f) { return f.body_force_on_bodies && !f.has_body_force(); },
             "there is no body force; remove it"},
        IdleInCase{pushes_no_bodies, no_free_bodies}},
    Key{"quiet_start", &coupler::FluidSpec::quiet_start, Flag{},
        "starts from rest with the pressure that balances weights, springs, the body force and buoyancy, so "
        "that no sound waves arise",
        nullptr,
        IdleInCase{
            [](const Case& c) { return is_quiet_in_vain(c) && begins_at_rest(c); },
            "neither weights nor springs nor a body force nor buoyancy push anything at the start; remove "
            "it"},
        IdleInCase{[](const Case& c) { return is_quiet_in_vain(c) && !begins_at_rest(c); },
                   "the case does not begin at rest; remove it, or what moves the fluid at the start"}},
    HandKey{"initial", "table", "", "at rest", "initial state, see below"}};

constexpr std::tuple initial_keys{
    Key{"type", &coupler::InitialSpec::type, Choice{coupler::initial_flow_names},
        "initial flow; \"taylor-green-3d\" needs a cube, \"vortex\" is about the axis z through the middle "
        "of the domain",
        required},
    Key{"noise", &coupler::InitialSpec::noise, Number{dimension::velocity, range::at_least(0)},
        "largest component of an additional random velocity of each cell, the same on any number of ranks"}};
constexpr std::tuple stream_keys{Key{"velocity", &coupler::InitialSpec::velocity, Vector{dimension::velocity},
                                     "velocity of the uniform flow and of the stream that carries a "
                                     "\"vortex\"; its length is the amplitude of the others; not at rest",
                                     required}};
constexpr std::tuple layer_keys{Key{"steepness", &coupler::InitialSpec::steepness,
                                    Number{dimension::none, range::above(0)},
                                    "of a \"shear-layer\": the period in y over the layers' thickness"}};
constexpr std::tuple vortex_keys{
    Key{"swirl", &coupler::InitialSpec::swirl, Number{dimension::velocity, range::at_least(0)},
        "of a \"vortex\": the largest speed about its axis", required},
    Key{"radius", &coupler::InitialSpec::radius, Number{dimension::length, range::above(0)},
        "of a \"vortex\": distance from its axis at which it is fastest", required}};

constexpr std::tuple gravity_keys{
    Key{"acceleration", &Case::gravity, Vector{dimension::acceleration},
        "acts on the bodies, less their buoyancy, as in [0, 0, -9.81]", required},
    HandKey{"over_time", "table", "", "steady", "how it changes, see below",
            Rule{If::idle, is_zero(&Case::gravity), "the acceleration is 0"}}};

/// Returns whether moving surfaces cover or uncover cells.
bool has_moving_surfaces(const Case& setup) {
  const auto moves = [](const BodySpec& body) { return body.motion != rigid::Motion::fixed; };
  const auto mesh_moves = [](const CurvedWall& wall) { return wall.mesh() && wall.moves(); };
  return !setup.fills.empty() || setup.any_given(moves) || std::ranges::any_of(setup.walls, mesh_moves);
}
constexpr IdleInCase unless_bodies_are_free{
    [](const Case& setup) { return setup.has_surfaces() && !setup.has_free_bodies(); }, no_free_bodies};
constexpr std::tuple coupling_keys{
    Key{"wall_scheme", &coupler::CouplingSpec::wall_scheme, Choice{coupler::wall_scheme_names},
        "boundary condition on the cut links of bodies and [[walls]]"},
    Key{"time", &coupler::CouplingSpec::time, Choice{coupler::time_coupling_names},
        "whether the drag of a step acts on the velocities at its end or at its start", nullptr,
        unless_bodies_are_free},
    Key{"force", &coupler::CouplingSpec::force, Choice{coupler::force_form_names},
        "momentum exchange; \"exact\" conserves momentum, and has the lift on bodies in a stream: "
        "comparison"},
    Key{"remap_tolerance", &coupler::CouplingSpec::remap_tolerance,
        Number{dimension::none, range::between(0, 0.4), "cells"},
        "largest distance of a surface from where its cells were last determined, at most 0.4; 0.15 of it "
        "where wall distances are not updated (bounce-back, meshes)",
        nullptr,
        IdleInCase{[](const Case& setup) { return setup.has_surfaces() && !has_moving_surfaces(setup); },
                   "no body and no mesh of [[walls]] moves; remove it"}},
    Key{"lubrication", &coupler::CouplingSpec::lubrication, Flag{},
        "lubrication between close smooth surfaces, with the resolver sffd; none at the faces and edges of "
        "boxes, cylinders and polyhedra",
        nullptr, unless_bodies_are_free},
    Key{"lubrication_min_gap", &coupler::CouplingSpec::lubrication_min_gap,
        Number{dimension::length, range::above(0)},
        "gap below which lubrication stops growing, as at rough surfaces; R is the reduced radius", "0.001 R",
        Rule{If::refused, is_zero(&coupler::CouplingSpec::lubrication),
             "{key} is given, but {table}.lubrication is false; remove one of them"},
        unless_bodies_are_free}};

/// Reads the keys of one type of initial flow; other types have none of them.
template <class Keys>
void read_keys_of(coupler::InitialFlow type, TableReader& initial, coupler::InitialSpec& spec,
                  const Keys& keys) {
  if (spec.type == type) return read_keys(initial, spec, keys);
  const auto refuse = [&](const char* key) {
    if (initial.has(key))
      initial.fail(key, "fluid.initial.{} is of \"{}\"; \"{}\" has none, remove it", key,
                   coupler::initial_flow_names[type], coupler::initial_flow_names[spec.type]);
  };
  std::apply([&](const auto&... key) { (refuse(key.name), ...); }, keys);
}

void read_initial(TableReader initial, coupler::InitialSpec& spec) {
  if (!initial.present()) return;
  const std::size_t errors_before = initial.context().errors.size();
  read_keys(initial, spec, initial_keys);
  if (initial.context().errors.size() > errors_before) return initial.judge_no_keys();  // of what type?
  read_keys_of(coupler::InitialFlow::shear_layer, initial, spec, layer_keys);
  read_keys_of(coupler::InitialFlow::vortex, initial, spec, vortex_keys);
  if (spec.type != coupler::InitialFlow::rest) return read_keys(initial, spec, stream_keys);
  initial.refuse_given({"velocity"},
                       "{key} is given, but {table}.type is \"rest\"; take \"uniform\", or remove it");
}

void read_coupling(TableReader& root, Case& setup) {
  TableReader table = root.table("coupling");
  if (table.present() && !setup.fluid)
    root.fail("coupling", "[coupling] is given, but there is no [fluid] to couple bodies to; remove it");
  read_keys(table, setup.coupling, coupling_keys);
}

void read_collision(TableReader& fluid, coupler::FluidSpec& spec) {
  std::vector<std::string> names;
  for (const lbm::CollisionModel& known : lbm::collision_models) names.emplace_back(known.name);
  names.emplace_back("auto");
  const std::optional<std::string> chosen = fluid.choice("collision", names);
  spec.collision_by_scene = chosen == "auto";
  const auto place = std::ranges::find(names, chosen.value_or("trt")) - names.begin();
  if (!spec.collision_by_scene) spec.collision = static_cast<lbm::Collision>(place);
  const lbm::CollisionModel& model = lbm::model_of(spec.collision);
  if (fluid.has("magic") && !model.has_magic())
    fluid.fail("magic", "fluid.magic is Lambda of trt and regularised; {} has none, remove it", model.name);
}

void read_viscosity(TableReader& fluid, coupler::FluidSpec& spec) {
  const std::string given = fluid.one_of({"kinematic_viscosity", "dynamic_viscosity", "relaxation_time"},
                                         true, "the viscosity of the fluid");
  if (given == "relaxation_time") {
    if (spec.relaxation_time <= 0.5) fluid.refuse(given, "above 0.5, where the viscosity is 0");
    spec.kinematic_viscosity = (spec.relaxation_time - 0.5) / 3;
  } else if (!given.empty()) {
    spec.relaxation_time = 0.5 + 3 * spec.kinematic_viscosity;
  }
}

// Limits of the method, in lattice units.
constexpr double doubtful_relaxation_low = 0.51, doubtful_relaxation_high = 2, high_relaxation = 5;
constexpr double most_relaxation = 1e4, usual_relaxation = 1;
constexpr double least_measured = 1e-4;  // of tau - 1/2, with any collision model (scripts/stability)
constexpr double most_cells = 1e13;      // far beyond the largest machines: a typing error

/// Returns the cure that gives a relaxation time of 1.
std::string shorter_steps(const Case& setup) {
  const double factor = (usual_relaxation - 0.5) / (setup.fluid->relaxation_time - 0.5);
  if (!gives_viscosity(setup))
    return fmt::format("use {} = {}", viscosity_key(setup), shown(usual_relaxation));
  return setup.units.si ? time_step_cure(setup, factor)
                        : fmt::format("use {} = {}", viscosity_key(setup),
                                      shown(factor * setup.fluid->kinematic_viscosity));
}

/// Returns "if fluid.dynamic_viscosity is in mPa s, write 0.01 (Pa s); else ", or "" where another key gives
/// it.
std::string millipascal_slip(const Case& setup) {
  constexpr double millipascals = 1000;
  const std::string_view key = viscosity_key(setup);
  if (!setup.units.si || key != "fluid.dynamic_viscosity") return "";
  const double found = setup.units.physical(setup.fluid->kinematic_viscosity, dimension::viscosity);
  return fmt::format("if {} is in mPa s, write {} (Pa s); else ", key,
                     shown(found * setup.units.density / millipascals));
}

void check_thick(const Case& setup, Diagnostics& findings, double tau) {
  const std::string found = fmt::format("the relaxation time is {}", shown(tau)), cure = shorter_steps(setup);
  const std::string factor = shown(rounded_up((tau - 0.5) / (usual_relaxation - 0.5)));
  const std::string doubt =
      ", and if the viscosity is meant, it is too large for this time step by a factor of " + factor;
  const std::string unit = tau > high_relaxation ? millipascal_slip(setup) : "";
  if (tau > most_relaxation)
    findings.error(viscosity_key(setup), "{}; at most {} is possible: {}{}{}", found, shown(most_relaxation),
                   unit, cure, doubt);
  else
    findings.warning(viscosity_key(setup), "{}; above {} walls and slow flow lose accuracy: {}{}{}", found,
                     doubtful_relaxation_high, unit, cure, tau > high_relaxation ? doubt : "");
}

void check_thin(const Case& setup, Diagnostics& findings, double tau) {
  const std::string lengths = length_slip(setup);
  findings.warning(viscosity_key(setup),
                   "the relaxation time is 0.5 + {}; no collision model was measured below 0.5 + {}: the "
                   "viscosity is too small for these cells by a factor of {}{}{}",
                   shown(tau - 0.5), least_measured, shown(rounded_up(least_measured / (tau - 0.5))),
                   lengths.empty() ? "" : "; ", lengths);
}

/// Reports a viscosity that no fluid has, with only the unit that would make it plausible, if there is one;
/// returns whether it did.
bool is_in_another_unit(const Case& setup, Diagnostics& findings) {
  const double tau = setup.fluid->relaxation_time;
  const double found = setup.units.physical(setup.fluid->kinematic_viscosity, dimension::viscosity);
  if (!setup.units.si || (found >= thinnest && found <= thickest)) return false;
  const std::string slip = viscosity_slip(setup);
  const std::string text = fmt::format(
      "the kinematic viscosity is {} m2/s; fluids have {} (a liquid metal) to {} (thick syrup), water has "
      "1e-06, which is 1 mm2/s{}{}{}",
      shown(found), shown(thinnest), shown(thickest),
      setup.places.count("fluid.dynamic_viscosity") ? " (a dynamic viscosity of 0.001 Pa s)" : "",
      slip.empty() ? "" : ": ", slip);
  if (slip.empty() || tau <= most_relaxation)
    findings.warning(viscosity_key(setup), "{}", text);
  else
    findings.error(viscosity_key(setup),
                   "{}; now it makes the relaxation time {}, and at most {} is possible", text, shown(tau),
                   shown(most_relaxation));
  return !slip.empty();
}

void check_viscosity(const Case& setup, Diagnostics& findings) {
  const double tau = setup.fluid->relaxation_time;
  const char* key = viscosity_key(setup);
  if (is_in_another_unit(setup, findings)) return;
  if (!(tau > 0.5))
    findings.error(key, "the relaxation time is {}; it must be above 0.5 (a viscosity above 0)", shown(tau));
  else if (tau - 0.5 < least_measured * (1 - unseen))
    check_thin(setup, findings, tau);
  else if (tau < doubtful_relaxation_low * (1 - unseen) &&
           !lbm::model_of(setup.fluid->collision).has_eddies())
    findings.warning(key,
                     "the relaxation time is {}; below {} runs tend to blow up: use fluid.collision = "
                     "\"regularised\", smaller cells, {} or a higher viscosity",
                     shown(tau), doubtful_relaxation_low, longer_step(setup));
  else if (tau > doubtful_relaxation_high)
    check_thick(setup, findings, tau);
}

/// Warns of slow flow between walls with another model than `trt` where that is stable.
void check_flow_between_walls(const Case& setup, Diagnostics& findings) {
  constexpr double same_from = 0.6;  // where `regularised` has the odd rates of `trt` (method.md, 26)
  const double tau = setup.fluid->relaxation_time, lasts = measured_reynolds(lbm::Collision::trt);
  if (setup.fluid->collision == lbm::Collision::trt || !setup.has_surfaces() || tau >= same_from ||
      tau < doubtful_relaxation_low || cell_reynolds(setup) > lasts)
    return;
  findings.warning("fluid.collision",
                   "below a relaxation time of {} flow between bodies has too much drag under {}, in a "
                   "packed bed with 12 cells a diameter at 0.5225 {}: use fluid.collision = \"trt\" where it "
                   "lasts, up to u/nu = {}, or smaller cells",
                   same_from, lbm::model_of(setup.fluid->collision).name,
                   setup.fluid->collision == lbm::Collision::bgk ? "a half" : "a third", shown(lasts));
}

void check_collision(const Case& setup, Diagnostics& findings) {
  const lbm::CollisionModel& model = lbm::model_of(setup.fluid->collision);
  const double found = cell_reynolds(setup), measured = measured_reynolds(setup.fluid->collision);
  if (found > measured)
    findings.warning("fluid.collision",
                     "the cell Reynolds number u/nu is {} at the largest speed given{}; {} was measured to "
                     "last up to {} (scripts/stability): use {}smaller cells",
                     shown(found), setup.coarsening ? " (of sides and of the start in the widest cells)" : "",
                     model.name, shown(measured),
                     model.has_eddies() ? "" : "fluid.collision = \"regularised\" or ");
  check_flow_between_walls(setup, findings);
  if (!possible_magic.holds(setup.fluid->magic))
    findings.error("fluid.magic", "fluid.magic is {}; it must be {}: 0.25 is usual",
                   shown(setup.fluid->magic), possible_magic.text());
}

void check_initial(const Case& setup, Diagnostics& findings) {
  const coupler::InitialSpec& initial = setup.fluid->initial;
  const auto& n = setup.cells;
  if (initial.type == coupler::InitialFlow::taylor_green_3d && (n[0] != n[1] || n[1] != n[2]))
    findings.error("fluid.initial.type",
                   "fluid.initial.type is \"taylor-green-3d\", whose pressure is known in a cube; make "
                   "domain.size the same along x, y and z");
  check_speed(findings, "fluid.initial.velocity", initial.largest_speed());
  check_speed(findings, "fluid.initial.noise", initial.noise);
}

}  // namespace

std::vector<KeySection> fluid_sections() {
  return {section_of("fluid", fluid_keys),
          section_of("fluid.initial", initial_keys, stream_keys, layer_keys, vortex_keys),
          section_of("gravity", gravity_keys), over_time_section(), section_of("coupling", coupling_keys)};
}

void read_fluid(TableReader& root, Case& setup) {
  TableReader fluid = root.table("fluid"), gravity = root.table("gravity");
  if (fluid.present()) {
    coupler::FluidSpec& spec = setup.fluid.emplace();
    spec.kinematic_viscosity = 1. / 6, spec.relaxation_time = 1;  // instead of wrong values (reported)
    read_keys(fluid, spec, fluid_keys);
    read_viscosity(fluid, spec);
    read_collision(fluid, spec);
    read_initial(fluid.table("initial"), spec.initial);
    spec.body_force_over_time = read_over_time(fluid, "body_force_over_time");
  }
  read_keys(gravity, setup, gravity_keys);
  setup.gravity_over_time = read_over_time(gravity, "over_time");
  read_coupling(root, setup);
  const bool surfaces = root.has("bodies") || root.has("fill") || root.has("walls");
  if (setup.fluid && surfaces && !fluid.has("magic"))
    setup.fluid->magic = lbm::best_magic(setup.coupling.wall_scheme, setup.fluid->relaxation_time);
}

void find_fluid_faults(const Case& setup, Diagnostics& findings) {
  if (!setup.fluid) return;
  if (setup.volume() > most_cells)
    findings.error("domain.size", "the domain has {} cells; at most {} are possible: {}use larger cells",
                   shown(setup.volume()), shown(most_cells), size_slip(setup));
  check_viscosity(setup, findings), check_collision(setup, findings), check_initial(setup, findings);
  look_for_idle_keys(findings, "fluid.", fluid_keys);
  look_for_idle_keys(findings, "coupling.", coupling_keys);
}

}  // namespace silt
