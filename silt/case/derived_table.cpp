
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "coupler/spec/flow_spec.hpp"
#include "lbm/blocks/lattice.hpp"
#include "rigid/math/elementary.hpp"
#include "rigid/shapes/shape.hpp"
#include "silt/case/case.hpp"
#include "silt/case/case_check.hpp"
#include "silt/case/fill_room.hpp"

namespace silt {
namespace {

// Lines of three columns, at least two blanks apart.
class Table {
 public:
  explicit Table(const Units& units) : units_(units) {}
  void line(const std::string& name, const std::string& in_case_units,
            const std::string& in_lattice_units = "") {
    text += fmt::format("  {:<24}  {:<32}  {}", name, in_case_units, in_lattice_units);
    text.erase(text.find_last_not_of(' ') + 1);
    text += '\n';
  }
  /// Adds numbers as shown(scale) writes them, in units of the case and of the lattice.
  template <class Shown>
  void numbers(const std::string& name, Dimension dimension, Shown&& shown, const char* remark = "") {
    const std::string in_lattice = fmt::format("{} {}{}", shown(1.), Units{}.unit_text(dimension), remark);
    if (units_.si)
      line(name, fmt::format("{} {}", shown(units_.scale(dimension)), units_.unit_text(dimension)),
           in_lattice);
    else
      line(name, in_lattice);
  }
  /// A quantity given in lattice units.
  void quantity(const std::string& name, double x, Dimension dimension, const char* remark = "") {
    numbers(
        name, dimension, [&](double scale) { return shown(x * scale); }, remark);
  }
  void heading(const std::string& name) { text += name + '\n'; }
  std::string text;

 private:
  const Units units_;
};

std::string three(const std::array<int, 3>& n, double scale = 1) {
  return fmt::format("{} x {} x {}", shown(n[0] * scale), shown(n[1] * scale), shown(n[2] * scale));
}

std::string side_text(const coupler::BoundarySpec& side) {
  return std::string(coupler::boundary_names[side.kind]) + (side.removes_bodies() ? " (bodies leave)" : "");
}

/// Returns the numbers of lines of a CSV file with numbers and with headings.
std::string lines_text(std::uint64_t numbers, int headings) {
  return fmt::format("{} lines of numbers, {} of headings", numbers, headings);
}

void add_file(const MeshFile& mesh, Table& table) {
  table.line("  of " + mesh.file, mesh.contents);
}

void add_wall(const CurvedWall& wall, Table& table) {
  if (const auto* tube = wall.tube())
    return table.quantity(fmt::format("tube '{}', radius", wall.name), tube->tube.radius, dimension::length);
  const MeshWall& mesh = *wall.mesh();
  const rigid::BoundingBox box = rigid::Mesh{mesh.mesh.surface, false}.bounding_box(mesh.pose(0));
  table.numbers("mesh '" + wall.name + "', box", dimension::length, [&](double scale) {
    std::vector<std::string> sides;
    for (int d = 0; d < 3; ++d)
      sides.push_back(fmt::format("{} to {}", shown(box.lower[d] * scale), shown(box.upper[d] * scale)));
    return joined(sides);
  });
  add_file(mesh, table);
  if (!mesh.table.empty())
    table.line("  moved by " + mesh.table, lines_text(mesh.motion.table.size(), mesh.table_headings));
}

void add_domain(const Case& setup, Table& table) {
  const auto& n = setup.cells;
  table.heading("domain");
  table.numbers("size", dimension::length, [&](double scale) { return three(n, scale); });
  table.line("cells", fmt::format("{:.0f}", setup.volume()));
  for (int d = 0; d < 3; ++d) {
    const auto &low = setup.boundary[2 * d], &high = setup.boundary[2 * d + 1];
    table.line(fmt::format("boundary {}", "xyz"[d]),
               setup.periodic(d) ? "periodic" : side_text(low) + ", " + side_text(high));
  }
  for (const CurvedWall& wall : setup.walls) add_wall(wall, table);
  if (setup.block_cells) {
    const auto& b = *setup.block_cells;
    std::int64_t blocks = 1;
    for (int d = 0; d < 3; ++d) blocks *= (n[d] + b[d] - 1) / b[d];
    table.line("blocks", fmt::format("{} of {} cells", blocks, three(b)));
  } else {
    table.line("blocks", "auto: by the number of ranks");
  }
  if (setup.units.si) {
    table.line("cell size", shown(setup.units.cell_size) + " m", "1");
    table.line("time step", shown(setup.units.time_step) + " s", "1");
  }
}

/// Adds lines for coarser lattices; their numbers of cells depend on the places of bodies.
void add_levels(const Case& setup, Table& table) {
  const coupler::CoarseningSpec& spec = *setup.coarsening;
  for (int level = 1; level <= spec.levels; ++level)
    table.line(fmt::format("  of cells {} times as wide", 1 << level), "",
               shown(0.5 + (setup.fluid->relaxation_time - 0.5) / (1 << level)));
  table.quantity("finest cells, up to", spec.distance, dimension::length);
}

void add_fluid(const Case& setup, Table& table) {
  if (!setup.fluid) {
    table.heading("fluid: none (dry run)");
    return;
  }
  const coupler::FluidSpec& fluid = *setup.fluid;
  table.heading("fluid");
  if (setup.units.si)
    table.line("density", shown(setup.units.density) + " kg/m3", "1");
  else
    table.line("density", "1");
  table.quantity("kinematic viscosity", fluid.kinematic_viscosity, dimension::viscosity);
  table.line("relaxation time", "", shown(fluid.relaxation_time));
  if (setup.coarsening) add_levels(setup, table);
  const lbm::CollisionModel& model = lbm::model_of(fluid.collision);
  std::string of = model.has_magic() ? ", Lambda = " + shown(fluid.magic) : "";
  if (fluid.collision_by_scene) of += " (" + collision_reason(setup) + ")";
  table.line("collision", std::string(model.name) + of);
  table.line("storage", std::string(coupler::precision_names[fluid.precision]));
  const double cells_of_longest_side = *std::ranges::max_element(setup.cells);
  table.quantity("sound crosses it in", cells_of_longest_side * std::sqrt(3.), dimension::time);
  if (const std::int64_t steps = quiet_start_steps(setup); steps > 0)
    table.line("quiet start", fmt::format("{} steps before the first find the pressure", steps));
  const double fastest = fastest_given(setup);
  if (fastest > 0) {
    table.quantity("largest given speed", fastest, dimension::velocity);
    table.line("  its Mach number", "", shown(fastest * std::sqrt(3.)));
    table.line("  its cell Reynolds number", setup.coarsening ? "largest of all widths" : "",
               shown(cell_reynolds(setup)));
  }
  if (fluid.body_force.norm() > 0)
    table.quantity("body force", fluid.body_force.norm(), dimension::acceleration);
  table.line("memory", fmt::format("{:.1f} MB in all{}", fluid_memory(setup) / 1e6,
                                   setup.coarsening ? " if every cell were finest" : ""));
}

/// Adds the numbers of heat in a fluid.
void add_heat(const Case& setup, Table& table) {
  if (!setup.heat) return;
  const double viscosity = setup.fluid->kinematic_viscosity, diffusivity = setup.heat->diffusivity;
  table.heading("heat");
  table.quantity("thermal diffusivity", diffusivity, dimension::viscosity);
  table.line("Prandtl number", shown(viscosity / diffusivity));
  const double longest = *std::ranges::max_element(setup.cells), cell = cell_peclet(setup);
  if (cell > 0)
    table.line("Peclet number of a cell", shown(cell),
               fmt::format("of the longest side {}", shown(cell * longest)));
  const rigid::Vec3 buoyancy(setup.heat->buoyancy.data());
  if (buoyancy.isZero(0)) return;
  int axis = 0;
  buoyancy.cwiseAbs().maxCoeff(&axis);
  const double height = setup.cells[axis];
  table.line("Rayleigh number",
             shown(buoyancy.norm() * given_temperatures(*setup.heat).difference() * height * height * height /
                   (viscosity * diffusivity)),
             fmt::format("of the height along {}", "xyz"[axis]));
}

/// Adds what bodies of a heat capacity must conduct to have one temperature: the Biot number h (V/A)/k of a
/// sphere below 0.1, with the Nusselt number of Ranz, Marshall, Chem. Eng. Prog. 48 (1952) 141 at this speed.
void add_biot(const Case& setup, Table& table, const Entry& kind, double diameter, double speed) {
  if (!setup.heat || setup.heat->kinds[kind.kind].capacity == 0) return;
  const double nu = setup.fluid->kinematic_viscosity;
  const double nusselt = 2 + 0.6 * std::sqrt(speed * diameter / nu) * std::cbrt(nu / setup.heat->diffusivity);
  constexpr double biot = 0.1;
  table.line("  of one temperature if",
             fmt::format("it conducts {} times as well as the fluid", shown(nusselt / (6 * biot))),
             fmt::format("Biot number below {}, Nusselt number about {}", biot, shown(nusselt)));
}

/// Adds bodies of one kind; of a fill of many sizes `kind` has the largest shape, `smallest` the other.
void add_kind(const Case& setup, Table& table, const std::string& name, const Entry& kind, int smallest) {
  const rigid::Shape& shape = setup.shapes[kind.shape];
  table.line(name, fmt::format("{} of shape '{}' ({})",
                               kind.count > 0 ? fmt::to_string(kind.count) : "those of initial.from,",
                               setup.shape_names[kind.shape], rigid::shape_name(shape)));
  if (const auto mesh = setup.meshes.find(setup.shape_names[kind.shape]); mesh != setup.meshes.end())
    add_file(mesh->second, table);
  table.quantity(smallest == kind.shape ? "  cells across" : "  cells across, smallest",
                 rigid::least_width(setup.shapes[smallest]), dimension::length);
  table.line("  density ratio", "", shown(kind.density));
  if (!setup.fluid) return;
  const double diameter = sphere_of_volume(shape), nu = setup.fluid->kinematic_viscosity;
  const double speed =
      kind.is_free() ? terminal_velocity(diameter, kind.density, setup.gravity.norm(), nu) : 0;
  add_biot(setup, table, kind, diameter, std::max(speed, fastest_given(setup)));
  if (!kind.is_free() || setup.gravity.norm() == 0) return;
  table.quantity("  terminal velocity", speed, dimension::velocity, " (sphere of its volume, unbounded)");
  table.line("  its Reynolds, Mach", "",
             fmt::format("{}, {}", shown(speed * diameter / nu), shown(speed * std::sqrt(3.))));
}

/// Returns the requested number of bodies, or else that of the sites, some of which may be occupied.
std::uint64_t most_bodies_of(const Case& setup, std::size_t fill) {
  const FillSpec& spec = setup.fills[fill];
  if (spec.count > 0) return static_cast<std::uint64_t>(spec.count);
  return lattice_of(setup, fill, rigid::bounding_radius(setup.shapes[spec.shape])).total();
}

/// Adds the share of the box, inside the domain, that is free for centres of bodies.
void add_room(const Case& setup, Table& table, std::size_t fill) {
  const FillSpec& spec = setup.fills[fill];
  const double radius = rigid::bounding_radius(setup.shapes[spec.shape]);
  const rigid::BoundingBox room = room_for_centres(setup, fill, radius);
  double share = setup.walls.empty() ? 1 : CurvedWalls(setup).share_left(room, radius + spec.gap);
  for (int d = 0; d < 3; ++d) {
    const double length = setup.cells[d], lower = spec.box.lower[d], upper = spec.box.upper[d];
    const double box =
        setup.periodic(d) ? std::min(upper - lower, length) : std::min(upper, length) - std::max(lower, 0.);
    share *= (room.upper[d] - room.lower[d]) / box;
  }
  table.line("  room for centres",
             fmt::format("{:.0f} % of the box: its faces and walls take the rest", 100 * share));
}

/// Adds the interval of a fill, and the number of bodies that arrive if there is always room.
void add_inflow(const Case& setup, Table& table, const FillSpec& fill, double count) {
  if (fill.every == 0) return;
  const std::int64_t again = std::max<std::int64_t>(setup.steps - 1, 0) / fill.every;
  table.line("  again", fmt::format("every {} steps, {} time{}", fill.every, again, again == 1 ? "" : "s"));
  const double a_step = count / static_cast<double>(fill.every);
  const double mass = a_step * fill.density * mean_volume(setup, fill);
  table.quantity("  bodies at most", a_step, {0, -1, 0});
  table.quantity("  their mass", mass, {0, -1, 1});
}

void add_sizes(const Case& setup, Table& table, const FillSpec& fill) {
  const std::size_t count = fill.sizes.size();
  if (count == 1) return;
  const auto diameter = [&](double volume) {
    return shown_length(setup, rigid::elementary::cbrt(6 / std::numbers::pi * volume));
  };
  const auto of = [&](const FillSize& size) {
    return diameter(rigid::mass_properties(setup.shapes[size.shape]).volume);
  };
  table.line("  diameters",
             fmt::format("{} sizes, {} to {}; mean {} (of mass)", count, of(fill.sizes.front()),
                         of(fill.sizes.back()), diameter(mean_volume(setup, fill))));
}

void add_bodies(const Case& setup, Table& table) {
  if (!setup.has_bodies()) {
    table.heading("bodies: none");
    return;
  }
  table.heading("bodies");
  if (setup.gravity.norm() > 0) table.quantity("gravity", setup.gravity.norm(), dimension::acceleration);
  double volume = 0;
  std::vector<Entry> entries = entries_of(setup);
  std::erase_if(entries, [](const Entry& entry) { return entry.key.starts_with("fill"); });
  const std::size_t given = entries.size();
  constexpr std::size_t most_lines = 12;
  for (std::size_t i = 0; i < std::min(given, most_lines); ++i) {
    add_kind(setup, table, entries[i].key, entries[i], entries[i].shape);
    for (const FiledBodies& filed : setup.filed)
      if (entry_key(filed.alike.entry) == entries[i].key && filed.positions.dataset.empty())
        table.line("  in " + filed.positions.file,
                   lines_text(filed.contents.points, filed.contents.headings));
  }
  if (given > most_lines) table.line("", fmt::format("and {} more entries", given - most_lines));
  for (const Entry& entry : entries)
    volume += static_cast<double>(entry.count) * rigid::mass_properties(setup.shapes[entry.shape]).volume;
  const std::vector<Entry> continued = continued_entries_of(setup);
  for (std::size_t i = 0; i < continued.size(); ++i) {
    Entry all = continued[i];
    all.shape = setup.continued[i].shape;
    add_kind(setup, table, fmt::format("{} {}", all.key, setup.kind_names[all.kind]), all,
             continued[i].shape);
  }
  for (std::size_t i = 0; i < setup.fills.size(); ++i) {
    const FillSpec& fill = setup.fills[i];
    Entry all{fill, fmt::format("fill[{}]", i)};
    all.count = most_bodies_of(setup, i);
    add_kind(setup, table, fmt::format("{} {}", all.key, setup.kind_names[fill.kind]), all,
             fill.sizes.front().shape);
    add_sizes(setup, table, fill);
    add_room(setup, table, i);
    add_inflow(setup, table, fill, static_cast<double>(all.count));
    volume += static_cast<double>(all.count) * mean_volume(setup, fill);
  }
  for (std::size_t i = 0; i < setup.outflows.size(); ++i)
    table.line(fmt::format("outflow[{}]", i), shown_box(setup, setup.outflows[i].box));
  table.line("volume fraction",
             fmt::format("{:.2f} %{}", 100 * volume / setup.volume(),
                         setup.continued.empty() ? "" : ", those of initial.from besides"));
  table.line("collision backend", setup.contacts.backend);
  table.line("contact resolver", setup.contacts.resolver);
  if (setup.fluid) table.line("lubrication", setup.has_lubrication() ? "on" : "off");
}

void add_run(const Case& setup, Table& table) {
  table.heading("run");
  table.quantity("length", static_cast<double>(setup.steps), dimension::time);
  const OutputSpec& output = setup.output;
  const auto series = [&](const std::string& name, std::int64_t every, bool at_start) {
    if (every <= 0) return;
    const std::int64_t times = (setup.steps - 1) / every + 1 + at_start;
    table.line(name, fmt::format("every {} steps, {}at the end, {} time{}", every,
                                 at_start ? "at the start and " : "and ", times, times > 1 ? "s" : ""));
  };
  series("fields", output.fields.every, true);
  for (const FieldsSpec& slice : output.slices) series(slice.name, slice.every, true);
  series("bodies", output.bodies.every, true);
  series("checkpoints", output.checkpoint.every, false);
  series("reports", output.report.every, false);
}

}  // namespace

int populations_of(const Case& setup) {
  return lbm::D3Q19::directions + (setup.heat ? lbm::D3Q7::directions : 0);
}

double fluid_memory(const Case& setup) {
  if (!setup.fluid) return 0;
  return setup.volume() *
         (populations_of(setup) * (setup.fluid->precision == coupler::Precision::double_ ? 8 : 4) +
          (setup.has_surfaces() ? 1 : 0));
}

std::string derived_table(const Case& setup) {
  Table table(setup.units);
  if (!setup.title.empty()) table.heading(setup.title);
  add_domain(setup, table);
  add_fluid(setup, table);
  add_heat(setup, table);
  add_bodies(setup, table);
  add_run(setup, table);
  return table.text;
}

}  // namespace silt
