// [units], [domain], [fluid], [coupling], [gravity]
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "coupler/case/case.hpp"
#include "coupler/case/case_sections.hpp"

namespace silt::coupler {
namespace {

// units.max_velocity becomes this lattice velocity: error by compressibility ~ u^2 = 0.25 %
constexpr double target_lattice_velocity = 0.05;
// how far, in cells, a size may be from a whole number of cells (rounding of decimal fractions)
constexpr double cell_count_tolerance = 1e-6;
constexpr double most_cells_an_axis = 1 << 20;

constexpr const char* axis_names[3] = {"x", "y", "z"};

void read_time_step(TableReader& units, TableReader& fluid, Case& scene) {
  const std::string given =
      units.one_of({"time_step", "relaxation_time", "max_velocity"}, true, "they fix the length of a step");
  Units& u = scene.units;
  if (given == "time_step") {
    u.time_step = units.number("time_step", range::above(0)).value_or(0);
  } else if (!given.empty() && !fluid.present()) {
    units.fail(given, fmt::format("units.{} needs a [fluid]; give units.time_step in a dry case", given));
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
  constexpr double water = 1000;  // kg/m3, where a dry case gives no density
  Units& u = scene.units;
  u.si = true;
  if (!units.has("cell_size")) units.missing("cell_size", "the length of a cell in m");
  u.cell_size = units.number("cell_size", range::above(0)).value_or(0);
  read_time_step(units, fluid, scene);
  if (fluid.present()) {
    if (units.has("density"))
      units.fail("density", "units.density is only for cases without [fluid]; it is fluid.density");
    if (!fluid.has("density")) fluid.missing("density", "the density of the fluid in kg/m3");
    u.density = fluid.number("density", range::above(0)).value_or(0);
  } else {
    u.density = units.has("density") ? units.number("density", range::above(0)).value_or(0) : water;
  }
}

std::optional<BoundaryKind> boundary_kind(const std::string& name) {
  const auto& names = boundary_names.names;
  const auto found = std::find(names.begin(), names.end(), name);
  return found == names.end() ? std::nullopt : std::optional(BoundaryKind(found - names.begin()));
}

// One side: a name, or a table with a type and what goes with it; none if it has errors.
std::optional<BoundarySpec> read_side(ReadContext& context, const Node& node, const std::string& path) {
  BoundarySpec side;
  const std::size_t errors_before = context.errors.size();
  const Place place = node.key.empty() ? node.place : node.key_place;
  if (node.kind == Node::Kind::string) {
    if (const auto kind = boundary_kind(node.string)) {
      side.kind = *kind;
      if (side.kind == BoundaryKind::moving || side.kind == BoundaryKind::velocity_inlet)
        context.fail(
            place,
            fmt::format("{} is \"{}\", which needs a velocity: {{ type = \"{}\", velocity = [x, y, z] }}",
                        path, node.string, node.string));
    } else {
      const std::string nearest = nearest_name(node.string, boundary_names.list());
      context.fail(place, fmt::format("{} is \"{}\"; it must be one of {}{}", path, node.string,
                                      joined(boundary_names.list()),
                                      nearest.empty() ? "" : "; did you mean '" + nearest + "'?"));
    }
    return context.errors.size() == errors_before ? std::optional(side) : std::nullopt;
  }
  if (node.kind != Node::Kind::table) {
    context.fail(place, fmt::format("{} is {}; it must be one of {}, or a table with a type", path,
                                    written(node), joined(boundary_names.list())));
    return {};
  }
  TableReader table(context, &node, path, place);
  if (!table.has("type")) table.missing("type", "one of " + joined(boundary_names.list()));
  side.kind = table.choice("type", boundary_names).value_or(side.kind);
  if (side.kind == BoundaryKind::moving || side.kind == BoundaryKind::velocity_inlet) {
    if (!table.has("velocity")) table.missing("velocity", "of the wall or the incoming fluid, [x, y, z]");
    side.velocity = table.vector("velocity", dimension::velocity).value_or(rigid::Vec3::Zero());
  }
  if (side.kind == BoundaryKind::pressure_outlet)
    side.density = table.quantity("density", dimension::density, range::above(0)).value_or(1);
  side.solid_for_bodies = table.boolean("solid_for_bodies").value_or(true);
  side.leaving = table.choice("leaving", leaving_names).value_or(side.leaving);
  if (table.has("leaving") && !side.lets_bodies_pass())
    table.fail("leaving",
               fmt::format("{} is of a side that bodies leave by; set solid_for_bodies = false, or "
                           "remove the key",
                           table.path("leaving")));
  return context.errors.size() == errors_before ? std::optional(side) : std::nullopt;
}

void read_axis(TableReader& boundary, int axis, Case& scene) {
  const std::string name = axis_names[axis];
  const Node* node = boundary.find(name);
  if (!node) {
    boundary.missing(name, "\"periodic\", or the kinds of its two sides, [low, high]");
    return;
  }
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
    boundary.fail(
        name, fmt::format("{} is periodic on one side only; a periodic axis has no sides, write \"periodic\"",
                          boundary.path(name)));
}

void read_boundary(TableReader& domain, Case& scene) {
  const Node* node = domain.find("boundary");
  if (node && node->kind == Node::Kind::string) {  // one kind all round
    scene.boundary.fill(read_side(domain.context(), *node, "domain.boundary").value_or(BoundarySpec{}));
    return;
  }
  if (!node) domain.missing("boundary", "{ x = ..., y = ..., z = ... }, each \"periodic\" or [low, high]");
  TableReader boundary = domain.table("boundary");
  if (boundary.present())
    for (int axis = 0; axis < 3; ++axis) read_axis(boundary, axis, scene);
}

void read_cells(TableReader& domain, Case& scene) {
  if (!domain.has("size")) domain.missing("size", "the lengths of the domain, [x, y, z]");
  const auto size = domain.vector("size");
  if (!size || !domain.context().units_known) return;
  const double cell = scene.units.cell_size;
  bool whole = true;
  rigid::Vec3 nearest;
  for (int d = 0; d < 3; ++d) {
    const double cells = (*size)[d] / cell, n = std::max(1.0, std::round(cells));
    if (cells > most_cells_an_axis) {
      domain.fail("size", fmt::format("domain.size[{}] is {} cells; at most {:.0f} are possible", d,
                                      shown(cells), most_cells_an_axis));
      return;
    }
    whole = whole && std::abs(cells - n) <= cell_count_tolerance;
    nearest[d] = n * cell;
    scene.cells[d] = static_cast<int>(n);
  }
  if (!whole)
    domain.fail("size",
                fmt::format("domain.size is [{}, {}, {}]; it must be whole multiples of the cell size {}, at "
                            "least one; the nearest is [{}, {}, {}]",
                            shown((*size)[0]), shown((*size)[1]), shown((*size)[2]), shown(cell),
                            shown(nearest[0]), shown(nearest[1]), shown(nearest[2])));
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

void read_initial(TableReader& fluid, InitialSpec& spec) {
  TableReader initial = fluid.table("initial");
  if (!initial.present()) return;
  if (!initial.has("type")) initial.missing("type", "one of " + joined(initial_flow_names.list()));
  spec.type = initial.choice("type", initial_flow_names).value_or(spec.type);
  spec.noise = initial.quantity("noise", dimension::velocity, range::at_least(0)).value_or(0);
  const auto of = [&](const char* key, InitialFlow type) {
    const bool given = initial.has(key);
    if (given && spec.type != type)
      initial.fail(key, fmt::format("fluid.initial.{} is of \"{}\"; \"{}\" has none, remove it", key,
                                    initial_flow_names[type], initial_flow_names[spec.type]));
    else if (!given && spec.type == InitialFlow::vortex && type == spec.type)
      initial.missing(key,
                      "the largest speed about the axis of a vortex (swirl), and how far from it (radius)");
    return given && spec.type == type;
  };
  if (of("steepness", InitialFlow::shear_layer))
    spec.steepness = initial.number("steepness", range::above(0)).value_or(spec.steepness);
  if (of("perturbation", InitialFlow::shear_layer))
    spec.perturbation = initial.number("perturbation", range::at_least(0)).value_or(spec.perturbation);
  if (of("swirl", InitialFlow::vortex))
    spec.swirl = initial.quantity("swirl", dimension::velocity, range::at_least(0)).value_or(0);
  if (of("radius", InitialFlow::vortex))
    spec.radius = initial.quantity("radius", dimension::length, range::above(0)).value_or(1);
  if (spec.type == InitialFlow::rest) return;
  if (!initial.has("velocity")) initial.missing("velocity", "of the fluid at the start, [x, y, z]");
  spec.velocity = initial.vector("velocity", dimension::velocity).value_or(rigid::Vec3::Zero());
}

void read_coupling(TableReader& root, Case& scene) {
  TableReader table = root.table("coupling");
  if (!table.present()) return;
  if (!scene.fluid)
    root.fail("coupling", "[coupling] is given, but there is no [fluid] to couple bodies to; remove it");
  CouplingSpec& c = scene.coupling;
  c.wall_scheme = table.choice("wall_scheme", wall_scheme_names).value_or(c.wall_scheme);
  c.time = table.choice("time", time_coupling_names).value_or(c.time);
  c.refill = table.choice("refill", refill_names).value_or(c.refill);
  c.force = table.choice("force", force_form_names).value_or(c.force);
  c.mass_correction = table.boolean("mass_correction").value_or(c.mass_correction);
  c.remap_tolerance = table.number("remap_tolerance", range::between(0, 0.4)).value_or(c.remap_tolerance);
  c.lubrication = table.boolean("lubrication").value_or(c.lubrication);
  c.lubrication_min_gap =
      table.quantity("lubrication_min_gap", dimension::length, range::above(0)).value_or(0);
  if (table.has("lubrication_min_gap") && !c.lubrication)
    table.fail("lubrication_min_gap",
               fmt::format("{} is given, but {} is false; remove one of them",
                           table.path("lubrication_min_gap"), table.path("lubrication")));
}

}  // namespace

void read_units(TableReader& root, Case& scene) {
  if (!root.has("units")) root.missing("units", "a table [units] with system = \"si\" or \"lattice\"");
  TableReader units = root.table("units"), fluid = root.table("fluid");
  if (units.present() && !units.has("system")) units.missing("system", "\"si\" or \"lattice\"");
  const auto system = units.choice("system", {"si", "lattice"});
  fluid.has("density");
  if (!system) units.judge_no_keys();
  if (system == "si") {
    read_si_scales(units, fluid, scene);
  } else if (system == "lattice") {
    const auto density = fluid.number("density", range::above(0));
    if (density && *density != 1)
      fluid.fail("density",
                 fmt::format("fluid.density is {}; in lattice units it is 1, and densities of bodies are "
                             "relative to it",
                             shown(*density)));
  }
  Units& u = scene.units;
  ReadContext& context = root.context();
  context.units_known = system && u.cell_size > 0 && u.time_step > 0 && u.density > 0;
  if (!context.units_known) u = Units{};
  context.units = u;
}

void read_domain(TableReader& root, Case& scene) {
  if (!root.has("domain")) root.missing("domain", "a table [domain] with size and boundary");
  TableReader domain = root.table("domain");
  if (!domain.present()) return;
  read_cells(domain, scene);
  read_boundary(domain, scene);
  read_blocks(domain, scene);
}

namespace {
void read_collision(TableReader& fluid, FluidSpec& spec) {
  std::vector<std::string> names = collision_names.list();
  names.emplace_back("auto");
  const std::optional<std::string> chosen = fluid.choice("collision", names);
  spec.collision_by_scene = chosen == "auto";
  const auto place = std::find(names.begin(), names.end() - 1, chosen.value_or("trt")) - names.begin();
  if (!spec.collision_by_scene) spec.collision = static_cast<lbm::Collision>(place);
  const lbm::CollisionModel& model = lbm::model_of(spec.collision);
  if (fluid.has("smagorinsky") && !model.has_eddies() && !spec.collision_by_scene)
    fluid.fail("smagorinsky",
               fmt::format("fluid.smagorinsky is of regularised; {} has none, remove it", model.name));
  spec.smagorinsky = fluid.number("smagorinsky", range::between(0, 1)).value_or(spec.smagorinsky);
  if (fluid.has("magic") && !model.has_magic())
    fluid.fail("magic", fmt::format("fluid.magic is Lambda of trt and regularised; {} has none, remove it",
                                    model.name));
}
}  // namespace

void read_fluid(TableReader& root, Case& scene) {
  TableReader fluid = root.table("fluid");
  if (fluid.present()) {
    FluidSpec& spec = scene.fluid.emplace();
    const std::string given =
        fluid.one_of({"kinematic_viscosity", "relaxation_time"}, true, "how viscous the fluid is");
    if (given == "relaxation_time") {
      spec.relaxation_time = fluid.number(given, range::any).value_or(1);
      if (spec.relaxation_time <= 0.5) fluid.refuse(given, "above 0.5, where the viscosity is 0");
      spec.kinematic_viscosity = (spec.relaxation_time - 0.5) / 3;
    } else if (!given.empty()) {
      spec.kinematic_viscosity =
          fluid.quantity(given, dimension::viscosity, range::above(0)).value_or(1. / 6);
      spec.relaxation_time = 0.5 + 3 * spec.kinematic_viscosity;
    }
    read_collision(fluid, spec);
    spec.precision = fluid.choice("precision", precision_names).value_or(spec.precision);
    spec.body_force = fluid.vector("body_force", dimension::acceleration).value_or(spec.body_force);
    spec.body_force_on_bodies = fluid.boolean("body_force_on_bodies").value_or(spec.body_force_on_bodies);
    read_initial(fluid, spec.initial);
  }
  TableReader gravity = root.table("gravity");
  if (gravity.present()) {
    if (!gravity.has("acceleration")) gravity.missing("acceleration", "[x, y, z], as in [0, 0, -9.81]");
    scene.gravity = gravity.vector("acceleration", dimension::acceleration).value_or(scene.gravity);
  }
  read_coupling(root, scene);
  if (!fluid.present()) return;
  const bool surfaces = root.has("bodies") || root.has("fill") || root.has("walls");
  const double best = surfaces ? lbm::best_magic(scene.coupling.wall_scheme, scene.fluid->relaxation_time)
                               : scene.fluid->magic;
  scene.fluid->magic = fluid.number("magic", range::above(0)).value_or(best);
}

}  // namespace silt::coupler
