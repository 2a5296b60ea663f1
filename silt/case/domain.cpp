// [units] and [domain] with its sides, and their checks.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "silt/case/case_check.hpp"
#include "silt/case/case_sections.hpp"

namespace silt {
namespace {

// the lattice value of units.max_velocity: compressibility error ~ u^2 = 0.25 %
constexpr double target_lattice_velocity = 0.05;
/// Returns how many cells `cells` may differ from a whole number, for rounded decimals: 1 in a million.
double cell_count_tolerance(double cells) {
  return unseen * std::max(1., cells);
}
constexpr double most_cells_an_axis = 1 << 20;

constexpr std::tuple system_keys{
    HandKey{"system", "\"si\", \"lattice\"", "", required,
            "\"si\" or \"lattice\": system of units of the whole file; the other keys are for \"si\""}};
struct GivenScales : Units {
  double relaxation_time = 0, max_velocity = 0;
};
constexpr std::tuple si_keys{
    Key{"cell_size", &Units::cell_size, Number{dimension::length, range::above(0)},
        "the length of a cell in m", required},
    Key{"time_step", &Units::time_step, Number{dimension::time, range::above(0)}, "length of a step",
        "one of three"},
    Key{"relaxation_time", &GivenScales::relaxation_time, Number{dimension::none, range::above(0.5)},
        "the step is chosen such that the fluid's viscosity has this relaxation time", "one of three"},
    Key{"max_velocity", &GivenScales::max_velocity, Number{dimension::velocity, range::above(0)},
        "the step is chosen such that this velocity is 0.05 cells per step", "one of three"}};

constexpr std::tuple domain_keys{
    HandKey{"size", "[x, y, z]", "m", required,
            "the lengths of the domain, [x, y, z], whole multiples of the cell size"},
    HandKey{"boundary", "table, or one kind", "", required,
            "the sides, { x = ..., y = ..., z = ... }, each \"periodic\" or [low, high]; one kind for all "
            "six is allowed"},
    HandKey{"blocks", "\"auto\", [x, y, z]", "cells", "\"auto\"",
            "size of the blocks that are distributed over the ranks; \"auto\": one block per rank, with "
            "about equal work"}};
constexpr const char *two_sides = "\"periodic\", [low, high]",
                     *kinds_of_sides =
                         "\"periodic\", or the kinds of its two sides, [low, high], each a name or a table";
constexpr std::tuple axis_keys{HandKey{"x", two_sides, "", required, kinds_of_sides},
                               HandKey{"y", two_sides, "", required, kinds_of_sides},
                               HandKey{"z", two_sides, "", required, kinds_of_sides}};
constexpr std::tuple side_keys{
    Key{"type", &coupler::BoundarySpec::kind, Choice{coupler::boundary_names},
        "kind of side; \"free-slip\" is a plane of symmetry, of bodies and walls, too", required},
    Key{"solid_for_bodies", &coupler::BoundarySpec::solid_for_bodies, Flag{},
        "whether the side is a wall for bodies, too; otherwise bodies beyond it are removed", nullptr,
        Rule{If::idle,
             [](const coupler::BoundarySpec& s) { return s.kind == coupler::BoundaryKind::periodic; },
             "a periodic axis has no sides; remove it"}}};
constexpr std::tuple velocity_keys{
    Key{"velocity", &coupler::BoundarySpec::velocity, Vector{dimension::velocity},
        "velocity of a moving wall or of the incoming fluid, [x, y, z]; only for those two", required},
    HandKey{"over_time", "table", "", "steady", "how the velocity changes: see gravity.over_time",
            Rule{If::idle, is_zero(&coupler::BoundarySpec::velocity), "the velocity is 0"}}};
constexpr std::tuple pressure_keys{Key{
    "pressure", &coupler::BoundarySpec::pressure, Number{dimension::pressure},
    "pressure at a pressure outlet, less that of the fluid at rest; without the hydrostatic pressure", "0"}};

/// Returns the length of a step, or 0 if it is wrong (reported).
double time_step_of(const GivenScales& scales, TableReader& units, TableReader& fluid) {
  const std::string given =
      units.one_of({"time_step", "relaxation_time", "max_velocity"}, true, "they fix the length of a step");
  if (given.empty() || given == "time_step") return scales.time_step;
  if (!fluid.present()) {
    units.fail(given, "units.{} needs a [fluid]; give units.time_step in a dry case", given);
    return 0;
  }
  const double cell_size = scales.cell_size, tau = scales.relaxation_time;
  if (given == "max_velocity")
    return scales.max_velocity > 0 ? target_lattice_velocity * cell_size / scales.max_velocity : 0;
  const bool dynamic = fluid.has("dynamic_viscosity");
  if (!dynamic) fluid.need("kinematic_viscosity", "units.relaxation_time derives the time step from it");
  const auto viscosity = fluid.number(dynamic ? "dynamic_viscosity" : "kinematic_viscosity", range::above(0));
  const double density = dynamic ? scales.density : 1;
  return tau > 0 && viscosity && density > 0
             ? (tau - 0.5) / 3 * cell_size * cell_size / (*viscosity / density)
             : 0;
}

Units read_si_scales(TableReader& units, TableReader& fluid) {
  constexpr double dry_scale = 1000;  // kg/m3: scale of mass without a fluid
  GivenScales u{{.cell_size = 0, .time_step = 0, .si = true}};
  read_keys(units, u, si_keys);
  u.density = fluid.present() ? fluid.number("density", range::above(0)).value_or(0) : dry_scale;
  u.time_step = time_step_of(u, units, fluid);
  if (fluid.present()) fluid.need("density", "the density of the fluid in kg/m3");
  return u;
}

void read_units(TableReader& root, Case& setup) {
  TableReader units = root.table("units"), fluid = root.table("fluid");
  read_keys(units, setup, system_keys);
  const auto system = units.choice("system", {"si", "lattice"});
  fluid.has("density");
  Units u;
  if (!system) units.judge_no_keys();
  if (system == "si") u = read_si_scales(units, fluid);
  if (system == "lattice")
    if (const auto density = fluid.number("density", range::above(0)); density && *density != 1)
      fluid.fail("density",
                 "fluid.density is {}; in lattice units it is 1, and densities of bodies are relative to it",
                 shown(*density));
  ReadContext& context = root.context();
  context.units_known = system && u.cell_size > 0 && u.time_step > 0 && u.density > 0;
  setup.units = context.units = context.units_known ? u : Units{};
}

void read_side_name(ReadContext& context, const Node& node, const std::string& path, const Place& place,
                    coupler::BoundarySpec& side) {
  const auto& names = coupler::boundary_names.names;
  const auto found = std::ranges::find(names, node.string);
  if (found == names.end()) {
    const std::string nearest = nearest_name(node.string, coupler::boundary_names.list());
    return context.fail(place, "{} is \"{}\"; it must be one of {}{}", path, node.string,
                        joined(coupler::boundary_names.list()),
                        nearest.empty() ? "" : "; did you mean '" + nearest + "'?");
  }
  side.kind = coupler::BoundaryKind(found - names.begin());
  if (side.traits().has_velocity)
    context.fail(place, "{} is \"{}\", which needs a velocity: {{ type = \"{}\", velocity = [x, y, z] }}",
                 path, node.string, node.string);
}

void read_side_table(TableReader table, coupler::BoundarySpec& side) {
  read_keys(table, side, side_keys);
  if (side.traits().has_velocity) {
    read_keys(table, side, velocity_keys);
    side.over_time = read_over_time(table, "over_time");
  }
  if (side.traits().has_pressure) read_keys(table, side, pressure_keys);
}

// Reads a side: a name, or a table with a type and its keys; none if it has errors.
std::optional<coupler::BoundarySpec> read_side(ReadContext& context, const Node& node,
                                               const std::string& path) {
  coupler::BoundarySpec side;
  const std::size_t errors_before = context.errors.size();
  const Place place = node.key.empty() ? node.place : node.key_place;
  if (node.kind == Node::Kind::string)
    read_side_name(context, node, path, place, side);
  else if (node.kind == Node::Kind::table)
    read_side_table({context, &node, path, place}, side);
  else
    context.fail(place, "{} is {}; it must be one of {}, or a table with a type", path, written(node),
                 joined(coupler::boundary_names.list()));
  return context.errors.size() == errors_before ? std::optional(side) : std::nullopt;
}

void read_axis(TableReader& boundary, int axis, Case& setup) {
  const std::string name(axis_names.names[axis]);
  const Node* node = boundary.find(name);
  if (!node) return;
  std::optional<coupler::BoundarySpec> sides[2];
  ReadContext& context = boundary.context();
  if (node->kind == Node::Kind::array) {
    if (node->children.size() != 2) return boundary.refuse(name, "\"periodic\" or two kinds, [low, high]");
    for (int side = 0; side < 2; ++side)
      sides[side] =
          read_side(context, node->children[side], fmt::format("{}[{}]", boundary.path(name), side));
  } else {
    sides[0] = sides[1] = read_side(context, *node, boundary.path(name));
  }
  if (!sides[0] || !sides[1]) return;
  for (int side = 0; side < 2; ++side) setup.boundary[2 * axis + side] = *sides[side];
  if (sides[0]->is_periodic() != sides[1]->is_periodic())
    boundary.fail(name, "{} is periodic on one side only; a periodic axis has no sides, write \"periodic\"",
                  boundary.path(name));
}

void read_boundary(TableReader& domain, Case& setup) {
  const Node* node = domain.find("boundary");
  if (node && node->kind == Node::Kind::string) {  // one kind for all sides
    setup.boundary.fill(
        read_side(domain.context(), *node, "domain.boundary").value_or(coupler::BoundarySpec{}));
    return;
  }
  TableReader boundary = domain.table("boundary");
  read_keys(boundary, setup, axis_keys);
  for (int axis = 0; axis < 3; ++axis) read_axis(boundary, axis, setup);
}

bool are_whole(const rigid::Vec3& cells) {
  return std::ranges::all_of(cells, [](double n) {
    return std::round(n) >= 1 && std::abs(n - std::round(n)) <= cell_count_tolerance(n);
  });
}

/// Returns ", or use units.cell_size = 0.000333333333333", the nearest one that fits the domain or the next
/// smaller, or "".
std::string or_fitting_cell(const Case& setup, const rigid::Vec3& size) {
  if (!setup.units.si || !(size.minCoeff() > 0)) return "";
  const double fitting = fitting_cell(size, std::round(size.minCoeff() / setup.units.cell_size));
  return fitting > 0 ? fmt::format(", or use units.cell_size = {:.12g}", fitting) : "";
}

void read_cells(TableReader& domain, Case& setup) {
  const auto size = domain.vector("size");
  if (!size || !domain.context().units_known) return;
  const double cell = setup.units.cell_size;
  const rigid::Vec3 cells = *size / cell, whole = cells.array().round().max(1);
  for (int d = 0; d < 3; ++d) {
    if (cells[d] > most_cells_an_axis)
      return domain.fail("size", "domain.size[{}] is {} cells; at most {:.0f} are possible", d,
                         shown(cells[d]), most_cells_an_axis);
    setup.cells[d] = static_cast<int>(whole[d]);
  }
  if (!are_whole(cells))
    domain.fail("size",
                "domain.size is {}; it must be whole multiples of the cell size {}, at least one; the "
                "nearest is {}{}",
                shown(*size), shown(cell), shown(rigid::Vec3(whole * cell)), or_fitting_cell(setup, *size));
}

void read_blocks(TableReader& domain, Case& setup) {
  const Node* node = domain.find("blocks");
  if (!node || (node->kind == Node::Kind::string && node->string == "auto")) return;
  const auto n = node->numbers(3);
  const bool good = n && std::all_of(n->begin(), n->end(), [](double x) {
                      return x > 0 && x <= most_cells_an_axis && x == std::floor(x);
                    });
  if (good)
    setup.block_cells = {int((*n)[0]), int((*n)[1]), int((*n)[2])};
  else
    domain.refuse("blocks", "\"auto\" or three whole numbers of cells above 0, [x, y, z]");
}

void check_velocity(const Case& setup, Diagnostics& findings, int side) {
  const coupler::BoundarySpec& of = setup.boundary[side];
  const std::string key = fmt::format("{}.velocity", side_key(side));
  const int axis = side / 2;
  check_speed(findings, key, of.largest_speed());
  const double inwards = side % 2 == 0 ? of.velocity[axis] : -of.velocity[axis];
  const auto shown_velocity = [&](const rigid::Vec3& v) {
    return shown(rigid::Vec3(v * setup.units.scale(dimension::velocity)));
  };
  rigid::Vec3 turned = of.velocity;
  turned[axis] = -turned[axis];
  if (of.is_wall() && inwards != 0)
    findings.error(key,
                   "{} moves through itself: the velocity of a moving wall must have no component along {}",
                   side_key(side), "xyz"[axis]);
  else if (of.is_inlet() && inwards < 0)
    findings.warning(
        key, "{} is {}, which points out of the domain: fluid leaves there; for an inlet use velocity = {}",
        key, shown_velocity(of.velocity), shown_velocity(turned));
  else if (of.is_inlet() && inwards == 0)
    findings.warning(
        key,
        "{} is {}, of which nothing goes along {}: no fluid comes in; for a wall that moves along itself use "
        "type = \"moving\"",
        key, shown_velocity(of.velocity), "xyz"[axis]);
}

void check_pressure(const Case& setup, Diagnostics& findings, int side) {
  constexpr double impossible_deviation = 0.5;
  const double pressure = setup.boundary[side].pressure;
  const double found = 3 * std::abs(pressure);  // the square of the speed of sound is 1/3
  if (found <= doubtful_deviation) return;
  const std::string key = fmt::format("{}.pressure", side_key(side));
  findings.add(found < impossible_deviation ? Diagnostic::Severity::warning : Diagnostic::Severity::error,
               key,
               fmt::format("{} is {}: it changes the density by {:.2g} %; above {} % the fluid is noticeably "
                           "compressible: {}",
                           key, shown(setup.units.physical(pressure, dimension::pressure)), 100 * found,
                           shown(100 * doubtful_deviation),
                           setup.units.si ? time_step_cure(setup, std::sqrt(doubtful_deviation / found))
                                          : "lower it"));
}

void check_flows(const Case& setup, Diagnostics& findings) {
  int inlet = -1;
  for (int side = 0; side < 6; ++side) {
    const coupler::BoundarySpec& of = setup.boundary[side];
    if (!setup.fluid && of.is_open())
      findings.warning(
          side_key(side),
          "{} is \"{}\", but the case has no [fluid]: bodies meet it as a wall; write \"no-slip\"",
          side_key(side), coupler::boundary_names[of.kind]);
    if (!setup.fluid) continue;
    if (of.traits().has_velocity) check_velocity(setup, findings, side);
    if (of.traits().has_pressure) check_pressure(setup, findings, side);
    if (of.is_inlet()) inlet = side;
  }
  if (inlet >= 0 && std::ranges::none_of(setup.boundary, &coupler::BoundarySpec::is_outlet))
    findings.error(side_key(inlet),
                   "{} is a velocity-inlet, but no side is a pressure-outlet: the density would grow without "
                   "end; make one side \"pressure-outlet\"",
                   side_key(inlet));
}

}  // namespace

double fitting_cell(const rigid::Vec3& size, double fewest) {
  constexpr int tries = 64;
  const double first = std::max(1., fewest);
  for (double n = first; n < first + tries; ++n)
    if (are_whole(size * n / size.minCoeff())) return size.minCoeff() / n;
  return 0;
}

double snapped(double x, int cells) {
  return x > cells && x <= cells + cell_count_tolerance(cells) ? cells : x;
}

rigid::Vec3 snapped(const rigid::Vec3& x, const std::array<int, 3>& cells) {
  return {snapped(x[0], cells[0]), snapped(x[1], cells[1]), snapped(x[2], cells[2])};
}

std::vector<KeySection> domain_sections() {
  return {section_of("units", system_keys, si_keys), section_of("domain", domain_keys),
          section_of("domain.boundary", axis_keys),
          section_of("domain.boundary.x", side_keys, velocity_keys, pressure_keys, side_heat_keys)};
}

void read_domain(TableReader& root, Case& setup) {
  read_units(root, setup);  // first, for conversions
  TableReader domain = root.table("domain");
  if (!domain.present()) return;
  read_keys(domain, setup, domain_keys);
  read_cells(domain, setup);
  read_boundary(domain, setup);
  read_blocks(domain, setup);
}

const char* side_key(int side) {
  constexpr const char* keys[6] = {"domain.boundary.x[0]", "domain.boundary.x[1]", "domain.boundary.y[0]",
                                   "domain.boundary.y[1]", "domain.boundary.z[0]", "domain.boundary.z[1]"};
  return keys[side];
}

void find_domain_faults(const Case& setup, Diagnostics& findings) {
  constexpr int thinnest_block = 2;  // cells: a layer for either side
  for (int d = 0; setup.block_cells && d < 3; ++d) {
    const int block = (*setup.block_cells)[d];
    if (block < std::min(thinnest_block, setup.cells[d]))
      findings.error("domain.blocks", "domain.blocks[{}] is {}; it must be at least {} cells", d, block,
                     thinnest_block);
    else if (block > setup.cells[d])
      findings.warning("domain.blocks", "domain.blocks[{}] is {} cells; the domain has only {} along {}", d,
                       block, setup.cells[d], "xyz"[d]);
  }
  check_flows(setup, findings);
  for (const auto& [path, place] : setup.places)
    if (!setup.has_bodies() && path.starts_with("domain.boundary") && path.ends_with(".solid_for_bodies"))
      findings.idle(path, "the case has no bodies; remove it");
}

}  // namespace silt
