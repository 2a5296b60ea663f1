// [units] and [domain] with its sides, and what may be wrong with them.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "coupler/case/case.hpp"
#include "coupler/case/case_sections.hpp"
#include "coupler/case/limits.hpp"

namespace silt::coupler {

namespace {

// units.max_velocity becomes this lattice velocity: error by compressibility ~ u^2 = 0.25 %
constexpr double target_lattice_velocity = 0.05;
// how far, in cells, a size may be from a whole number of cells (rounding of decimal fractions)
constexpr double cell_count_tolerance = 1e-6;
constexpr double most_cells_an_axis = 1 << 20;

constexpr std::tuple system_keys{
    HandKey{"system", "\"si\", \"lattice\"", "", required,
            "\"si\" or \"lattice\": system of units of the whole file; the other keys are for \"si\""}};
constexpr std::tuple si_keys{
    Key{"cell_size", &Units::cell_size, Number{dimension::length, range::above(0)},
        "the length of a cell in m", required},
    HandKey{"time_step", "number", "s", "one of three", "length of a step"},
    HandKey{"relaxation_time", "number", "1", "one of three",
            "a step as long as gives the fluid's viscosity this relaxation time"},
    HandKey{"max_velocity", "number", "m/s", "one of three",
            "a step as long as makes this velocity 0.05 cells a step"},
    HandKey{"density", "number", "kg/m³", "1000", "the scale of mass of a case without a fluid"}};

constexpr std::tuple domain_keys{
    HandKey{"size", "[x, y, z]", "m", required,
            "the lengths of the domain, [x, y, z], whole multiples of the cell size"},
    HandKey{"boundary", "table, or one kind", "", required,
            "the sides, { x = ..., y = ..., z = ... }, each \"periodic\" or [low, high]; one kind for all "
            "six is allowed"},
    HandKey{"blocks", "\"auto\", [x, y, z]", "cells", "\"auto\"",
            "size of the blocks that are dealt out to ranks; \"auto\": one a rank, of about the same work"}};
constexpr const char *two_sides = "\"periodic\", [low, high]",
                     *kinds_of_sides =
                         "\"periodic\", or the kinds of its two sides, [low, high], each a name or a table";
constexpr std::tuple axis_keys{HandKey{"x", two_sides, "", required, kinds_of_sides},
                               HandKey{"y", two_sides, "", required, kinds_of_sides},
                               HandKey{"z", two_sides, "", required, kinds_of_sides}};
constexpr std::tuple side_keys{
    Key{"type", &BoundarySpec::kind, Choice{boundary_names}, "kind of side", required},
    Key{"solid_for_bodies", &BoundarySpec::solid_for_bodies, Flag{},
        "whether the side is a wall for bodies too"},
    Key{"leaving", &BoundarySpec::leaving, Choice{leaving_names},
        "of a side that is none: bodies beyond it are taken out, or the run stops"}};
constexpr std::tuple velocity_keys{
    Key{"velocity", &BoundarySpec::velocity, Vector{dimension::velocity},
        "velocity of a moving wall or of the incoming fluid, [x, y, z]; only for those two", required}};
constexpr std::tuple density_keys{
    Key{"density", &BoundarySpec::density, Number{dimension::density, range::above(0)},
        "density at a pressure outlet: in this method density is pressure", "the fluid's"}};

void read_time_step(TableReader& units, TableReader& fluid, Case& scene) {
  const std::string given =
      units.one_of({"time_step", "relaxation_time", "max_velocity"}, true, "they fix the length of a step");
  Units& u = scene.units;
  if (given == "time_step") {
    u.time_step = units.number("time_step", range::above(0)).value_or(0);
  } else if (!given.empty() && !fluid.present()) {
    units.fail(given, "units.{} needs a [fluid]; give units.time_step in a dry case", given);
    u.time_step = 0;
  } else if (given == "max_velocity") {
    const auto velocity = units.number("max_velocity", range::above(0));
    u.time_step = velocity ? target_lattice_velocity * u.cell_size / *velocity : 0;
  } else if (given == "relaxation_time") {
    if (!fluid.has("kinematic_viscosity"))
      fluid.missing("kinematic_viscosity", "units.relaxation_time derives the time step from it");
    const auto tau = units.number("relaxation_time", range::above(0.5));
    const auto viscosity = fluid.number("kinematic_viscosity", range::above(0));
    u.time_step = tau && viscosity ? (*tau - 0.5) / 3 * u.cell_size * u.cell_size / *viscosity : 0;
  } else {
    u.time_step = 0;
  }
}

void read_si_scales(TableReader& units, TableReader& fluid, Case& scene) {
  constexpr double water = 1000;  // kg/m3
  Units& u = scene.units;
  u.si = true;
  u.cell_size = 0;
  read_keys(units, u, si_keys);
  read_time_step(units, fluid, scene);
  if (!fluid.present()) {
    u.density = units.has("density") ? units.number("density", range::above(0)).value_or(0) : water;
    return;
  }
  if (units.has("density"))
    units.fail("density", "units.density is only for cases without [fluid]; it is fluid.density");
  if (!fluid.has("density")) fluid.missing("density", "the density of the fluid in kg/m3");
  u.density = fluid.number("density", range::above(0)).value_or(0);
}

void read_side_name(ReadContext& context, const Node& node, const std::string& path, const Place& place,
                    BoundarySpec& side) {
  const auto& names = boundary_names.names;
  const auto found = std::find(names.begin(), names.end(), node.string);
  if (found == names.end()) {
    const std::string nearest = nearest_name(node.string, boundary_names.list());
    return context.fail(place, "{} is \"{}\"; it must be one of {}{}", path, node.string,
                        joined(boundary_names.list()),
                        nearest.empty() ? "" : "; did you mean '" + nearest + "'?");
  }
  side.kind = BoundaryKind(found - names.begin());
  if (side.has_velocity())
    context.fail(place, "{} is \"{}\", which needs a velocity: {{ type = \"{}\", velocity = [x, y, z] }}",
                 path, node.string, node.string);
}

void read_side_table(TableReader table, BoundarySpec& side) {
  read_keys(table, side, side_keys);
  if (side.has_velocity()) read_keys(table, side, velocity_keys);
  if (side.kind == BoundaryKind::pressure_outlet) read_keys(table, side, density_keys);
  if (table.has("leaving") && !side.lets_bodies_pass())
    table.fail("leaving",
               "{} is of a side that bodies leave by; set solid_for_bodies = false, or remove the key",
               table.path("leaving"));
}

// One side: a name, or a table with a type and what goes with it; none if it has errors.
std::optional<BoundarySpec> read_side(ReadContext& context, const Node& node, const std::string& path) {
  BoundarySpec side;
  const std::size_t errors_before = context.errors.size();
  const Place place = node.key.empty() ? node.place : node.key_place;
  if (node.kind == Node::Kind::string)
    read_side_name(context, node, path, place, side);
  else if (node.kind == Node::Kind::table)
    read_side_table({context, &node, path, place}, side);
  else
    context.fail(place, "{} is {}; it must be one of {}, or a table with a type", path, written(node),
                 joined(boundary_names.list()));
  return context.errors.size() == errors_before ? std::optional(side) : std::nullopt;
}

void read_axis(TableReader& boundary, int axis, Case& scene) {
  const std::string name(axis_names.names[axis]);
  const Node* node = boundary.find(name);
  if (!node) return;
  std::optional<BoundarySpec> sides[2];
  ReadContext& context = boundary.context();
  if (node->kind == Node::Kind::array) {
    if (node->children.size() != 2) {
      boundary.refuse(name, "\"periodic\" or two kinds, [low, high]");
      return;
    }
    for (int side = 0; side < 2; ++side)
      sides[side] =
          read_side(context, node->children[side], fmt::format("{}[{}]", boundary.path(name), side));
  } else {
    sides[0] = sides[1] = read_side(context, *node, boundary.path(name));
  }
  if (!sides[0] || !sides[1]) return;
  for (int side = 0; side < 2; ++side) scene.boundary[2 * axis + side] = *sides[side];
  if ((sides[0]->kind == BoundaryKind::periodic) != (sides[1]->kind == BoundaryKind::periodic))
    boundary.fail(name, "{} is periodic on one side only; a periodic axis has no sides, write \"periodic\"",
                  boundary.path(name));
}

void read_boundary(TableReader& domain, Case& scene) {
  const Node* node = domain.find("boundary");
  if (node && node->kind == Node::Kind::string) {  // one kind all round
    scene.boundary.fill(read_side(domain.context(), *node, "domain.boundary").value_or(BoundarySpec{}));
    return;
  }
  TableReader boundary = domain.table("boundary");
  read_keys(boundary, scene, axis_keys);
  for (int axis = 0; axis < 3; ++axis) read_axis(boundary, axis, scene);
}

void read_cells(TableReader& domain, Case& scene) {
  const auto size = domain.vector("size");
  if (!size || !domain.context().units_known) return;
  const double cell = scene.units.cell_size;
  bool whole = true;
  rigid::Vec3 nearest;
  for (int d = 0; d < 3; ++d) {
    const double cells = (*size)[d] / cell, n = std::max(1.0, std::round(cells));
    if (cells > most_cells_an_axis) {
      domain.fail("size", "domain.size[{}] is {} cells; at most {:.0f} are possible", d, shown(cells),
                  most_cells_an_axis);
      return;
    }
    whole = whole && std::abs(cells - n) <= cell_count_tolerance;
    nearest[d] = n * cell;
    scene.cells[d] = static_cast<int>(n);
  }
  if (!whole)
    domain.fail("size",
                "domain.size is [{}, {}, {}]; it must be whole multiples of the cell size {}, at least one; "
                "the nearest is [{}, {}, {}]",
                shown((*size)[0]), shown((*size)[1]), shown((*size)[2]), shown(cell), shown(nearest[0]),
                shown(nearest[1]), shown(nearest[2]));
}

void read_blocks(TableReader& domain, Case& scene) {
  const Node* node = domain.find("blocks");
  if (!node || (node->kind == Node::Kind::string && node->string == "auto")) return;
  std::array<int, 3> cells{};
  bool good = node->kind == Node::Kind::array && node->children.size() == 3;
  for (int d = 0; good && d < 3; ++d) {
    const Node& n = node->children[d];
    good = n.kind == Node::Kind::integer && n.integer > 0 && n.integer <= most_cells_an_axis;
    if (good) cells[d] = static_cast<int>(n.integer);
  }
  if (good)
    scene.block_cells = cells;
  else
    domain.refuse("blocks", "\"auto\" or three whole numbers of cells above 0, [x, y, z]");
}

}  // namespace

std::vector<KeySection> domain_sections() {
  return {section_of("units", system_keys, si_keys), section_of("domain", domain_keys),
          section_of("domain.boundary", axis_keys),
          section_of("domain.boundary.x", side_keys, velocity_keys, density_keys)};
}

void read_units(TableReader& root, Case& scene) {
  TableReader units = root.table("units"), fluid = root.table("fluid");
  read_keys(units, scene, system_keys);
  const auto system = units.choice("system", {"si", "lattice"});
  fluid.has("density");
  if (!system) units.judge_no_keys();
  if (system == "si") {
    read_si_scales(units, fluid, scene);
  } else if (system == "lattice") {
    const auto density = fluid.number("density", range::above(0));
    if (density && *density != 1)
      fluid.fail("density",
                 "fluid.density is {}; in lattice units it is 1, and densities of bodies are relative to it",
                 shown(*density));
  }
  Units& u = scene.units;
  ReadContext& context = root.context();
  context.units_known = system && u.cell_size > 0 && u.time_step > 0 && u.density > 0;
  if (!context.units_known) u = Units{};
  context.units = u;
}

void read_domain(TableReader& root, Case& scene) {
  TableReader domain = root.table("domain");
  if (!domain.present()) return;
  read_keys(domain, scene, domain_keys);
  read_cells(domain, scene);
  read_boundary(domain, scene);
  read_blocks(domain, scene);
}

namespace {

std::string velocity_key(int side) {
  return fmt::format("{}.velocity", side_key(side));
}

std::string shown_velocity(const Case& scene, const rigid::Vec3& v) {
  const double scale = scene.units.scale(dimension::velocity);
  return fmt::format("[{}, {}, {}]", shown(v[0] * scale), shown(v[1] * scale), shown(v[2] * scale));
}

void check_moving_wall(const Case& scene, Findings& findings, int side) {
  const BoundarySpec& wall = scene.boundary[side];
  check_speed(findings, velocity_key(side), wall.velocity.norm());
  if (std::abs(wall.velocity[side / 2]) > 0)
    findings.error(velocity_key(side),
                   "{} moves through itself: the velocity of a moving wall must have no component along {}",
                   side_key(side), "xyz"[side / 2]);
}

void check_inlet(const Case& scene, Findings& findings, int side) {
  const rigid::Vec3& velocity = scene.boundary[side].velocity;
  check_speed(findings, velocity_key(side), velocity.norm());
  const double inwards = side % 2 == 0 ? velocity[side / 2] : -velocity[side / 2];
  if (inwards > 0) return;
  rigid::Vec3 turned = velocity;
  turned[side / 2] = -turned[side / 2];
  findings.warning(
      velocity_key(side),
      inwards < 0
          ? fmt::format("{} is {}, which points out of the domain: fluid leaves there; for an inlet use "
                        "velocity = {}",
                        velocity_key(side), shown_velocity(scene, velocity), shown_velocity(scene, turned))
          : fmt::format("{} is {}, of which nothing goes along {}: no fluid comes in; for a wall that moves "
                        "along itself use type = \"moving\"",
                        velocity_key(side), shown_velocity(scene, velocity), "xyz"[side / 2]));
}

void check_outlet(const Case& scene, Findings& findings, int side) {
  const double density = scene.boundary[side].density;
  if (density > 0.5 && density < 1.5) return;
  findings.error(fmt::format("{}.density", side_key(side)),
                 "{}.density is {} times the fluid's; it must be between 0.5 and 1.5: in this method density "
                 "is pressure",
                 side_key(side), shown(density));
}

void check_flows(const Case& scene, Findings& findings) {
  int inlet = -1;
  bool outlet = false;
  for (int side = 0; side < 6; ++side) {
    const BoundaryKind kind = scene.boundary[side].kind;
    if (kind == BoundaryKind::moving) check_moving_wall(scene, findings, side);
    if (kind == BoundaryKind::velocity_inlet) check_inlet(scene, findings, inlet = side);
    if (kind == BoundaryKind::pressure_outlet) check_outlet(scene, findings, side), outlet = true;
  }
  if (inlet >= 0 && !outlet)
    findings.error(side_key(inlet),
                   "{} is a velocity-inlet, but no side is a pressure-outlet: the density would grow without "
                   "end; make one side \"pressure-outlet\"",
                   side_key(inlet));
}

/// A flow needs a fluid.
void check_dry_sides(const Case& scene, Findings& findings) {
  for (int side = 0; side < 6; ++side) {
    const BoundaryKind kind = scene.boundary[side].kind;
    if (kind == BoundaryKind::velocity_inlet || kind == BoundaryKind::pressure_outlet)
      findings.warning(
          side_key(side),
          "{} is \"{}\", but the case has no [fluid]: bodies meet it as a wall; write \"no-slip\"",
          side_key(side), boundary_names[kind]);
  }
}

constexpr int thinnest_block = 2;  // cells: a block needs a layer to send to either side

void check_domain(const Case& scene, Findings& findings) {
  for (int d = 0; d < 3; ++d) {
    if (scene.cells[d] < 1)
      findings.error("domain.size", "the domain has {} cells along {}; it must have at least 1",
                     scene.cells[d], "xyz"[d]);
    if (!scene.block_cells) continue;
    const int block = (*scene.block_cells)[d];
    if (block < std::min(thinnest_block, scene.cells[d]))
      findings.error("domain.blocks", "domain.blocks[{}] is {}; it must be at least {} cells", d, block,
                     thinnest_block);
    else if (block > scene.cells[d])
      findings.warning("domain.blocks", "domain.blocks[{}] is {} cells; the domain has only {} along {}", d,
                       block, scene.cells[d], "xyz"[d]);
  }
}

}  // namespace

const char* side_key(int side) {
  constexpr const char* keys[6] = {"domain.boundary.x[0]", "domain.boundary.x[1]", "domain.boundary.y[0]",
                                   "domain.boundary.y[1]", "domain.boundary.z[0]", "domain.boundary.z[1]"};
  return keys[side];
}

void find_domain_faults(const Case& scene, Findings& findings) {
  check_domain(scene, findings);
  for (int d = 0; d < 3; ++d)
    if ((scene.boundary[2 * d].kind == BoundaryKind::periodic) !=
        (scene.boundary[2 * d + 1].kind == BoundaryKind::periodic))
      findings.error(fmt::format("domain.boundary.{}", "xyz"[d]),
                     "domain.boundary.{} is periodic on one side only; a periodic axis has no sides",
                     "xyz"[d]);
  if (scene.fluid)
    check_flows(scene, findings);
  else
    check_dry_sides(scene, findings);
}

}  // namespace silt::coupler
