#include "coupler/case/derived_table.hpp"

#include <fmt/format.h>

#include <cmath>
#include <numbers>

#include "coupler/case/case.hpp"
#include "coupler/case/case_check.hpp"
#include "coupler/case/driving.hpp"
#include "coupler/case/fill_room.hpp"
#include "coupler/case/fluid_spec.hpp"
#include "rigid/shapes/shape.hpp"

namespace silt::coupler {
namespace {

constexpr int populations = 19;

// Lines of three columns, two blanks apart or more.
class Table {
 public:
  explicit Table(const Case& scene) : scene_(scene) {}
  void line(const std::string& name, const std::string& in_case_units,
            const std::string& in_lattice_units = "") {
    text += fmt::format("  {:<24}  {:<32}  {}", name, in_case_units, in_lattice_units);
    text.erase(text.find_last_not_of(' ') + 1);
    text += '\n';
  }
  /// A quantity given in lattice units.
  void quantity(const std::string& name, double x, Dimension dimension, const char* si, const char* lattice) {
    const std::string in_lattice = fmt::format("{} {}", shown(x), lattice);
    if (scene_.units.si)
      line(name, fmt::format("{} {}", shown(scene_.units.physical(x, dimension)), si), in_lattice);
    else
      line(name, in_lattice);
  }
  void heading(const std::string& name) { text += name + '\n'; }
  std::string text;

 private:
  const Case& scene_;
};

std::string three(double a, double b, double c) {
  return fmt::format("{} x {} x {}", shown(a), shown(b), shown(c));
}

std::string side_text(const BoundarySpec& side) {
  const char* leaving = side.removes_bodies() ? " (bodies leave)" : " (stops where a body leaves)";
  return std::string(boundary_names[side.kind]) + (side.lets_bodies_pass() ? leaving : "");
}

/// What was taken for numbers in a CSV file, and what not.
std::string lines_text(std::uint64_t numbers, int headings) {
  return fmt::format("{} lines of numbers, {} of headings", numbers, headings);
}

void add_wall(const Case& scene, const CurvedWall& wall, Table& table) {
  if (const auto* hollow = wall.hollow())
    return hollow->shape.for_sizes([&](const std::string& key, double size) {
      table.quantity(fmt::format("{} '{}', {}", hollow->shape.name(), wall.name, key), size,
                     dimension::length, "m", "cells");
    });
  const MeshWall& mesh = *wall.mesh();
  const rigid::BoundingBox box = rigid::Mesh{mesh.mesh.surface, false}.bounding_box(mesh.pose(0));
  const auto from_to = [&](double scale) {
    std::string text;
    for (int d = 0; d < 3; ++d)
      text +=
          fmt::format("{}{} to {}", d ? ", " : "", shown(box.lower[d] * scale), shown(box.upper[d] * scale));
    return text;
  };
  if (scene.units.si)
    table.line("mesh '" + wall.name + "', box", from_to(scene.units.cell_size) + " m", from_to(1) + " cells");
  else
    table.line("mesh '" + wall.name + "', box", from_to(1) + " cells");
  table.line("  of " + mesh.file, mesh.contents);
  if (!mesh.table.empty())
    table.line("  moved by " + mesh.table, lines_text(mesh.motion.table.size(), mesh.table_headings));
}

void add_domain(const Case& scene, Table& table) {
  const auto& n = scene.cells;
  const double cell = scene.units.cell_size;
  table.heading("domain");
  const std::string cells = three(n[0], n[1], n[2]) + " cells";
  if (scene.units.si)
    table.line("size", three(n[0] * cell, n[1] * cell, n[2] * cell) + " m", cells);
  else
    table.line("size", cells);
  table.line("cells", fmt::format("{}", std::int64_t{n[0]} * n[1] * n[2]));
  for (int d = 0; d < 3; ++d) {
    const auto &low = scene.boundary[2 * d], &high = scene.boundary[2 * d + 1];
    table.line(fmt::format("boundary {}", "xyz"[d]),
               scene.periodic(d) ? "periodic" : side_text(low) + ", " + side_text(high));
  }
  for (const CurvedWall& wall : scene.walls) add_wall(scene, wall, table);
  if (scene.block_cells) {
    const auto& b = *scene.block_cells;
    std::int64_t blocks = 1;
    for (int d = 0; d < 3; ++d) blocks *= (n[d] + b[d] - 1) / b[d];
    table.line("blocks", fmt::format("{} of {} cells", blocks, three(b[0], b[1], b[2])));
  } else {
    table.line("blocks", "auto: by the number of ranks");
  }
  if (scene.units.si) {
    table.line("cell size", shown(cell) + " m", "1");
    table.line("time step", shown(scene.units.time_step) + " s", "1");
  }
}

void add_fluid(const Case& scene, Table& table) {
  if (!scene.fluid) {
    table.heading("fluid: none (dry run)");
    return;
  }
  const FluidSpec& fluid = *scene.fluid;
  table.heading("fluid");
  table.quantity("density", 1, dimension::density, "kg/m3", "");
  table.quantity("kinematic viscosity", fluid.kinematic_viscosity, dimension::viscosity, "m2/s",
                 "cells2/step");
  table.line("relaxation time", "", shown(fluid.relaxation_time));
  const lbm::CollisionModel& model = lbm::model_of(fluid.collision);
  std::string of = model.has_magic() ? ", Lambda = " + shown(fluid.magic) : "";
  if (model.has_eddies()) of += ", Smagorinsky constant " + shown(fluid.smagorinsky);
  if (fluid.collision_by_scene) of += " (" + collision_reason(scene) + ")";
  table.line("collision", std::string(model.name) + of);
  table.line("storage", std::string(precision_names[fluid.precision]));
  const double fastest = fastest_given(scene);
  if (fastest > 0) {
    table.quantity("largest given speed", fastest, dimension::velocity, "m/s", "cells/step");
    table.line("  its Mach number", "", shown(fastest * std::sqrt(3.)));
    table.line("  its cell Reynolds number", "", shown(cell_reynolds(scene)));
  }
  if (fluid.body_force.norm() > 0)
    table.quantity("body force", fluid.body_force.norm(), dimension::acceleration, "m/s2", "cells/step2");
  table.line("memory", fmt::format("{:.1f} MB in all", fluid_memory(scene) / 1e6));
}

void add_kind(const Case& scene, Table& table, const std::string& name, const Entry& kind) {
  const rigid::Shape& shape = scene.shapes[kind.shape];
  const double volume = rigid::mass_properties(shape).volume;
  table.line(name, fmt::format("{} of shape '{}' ({})", kind.count, scene.shape_names[kind.shape],
                               rigid::shape_name(shape)));
  table.quantity("  cells across", rigid::least_width(shape), dimension::length, "m", "cells");
  table.line("  density ratio", "", shown(kind.density));
  if (!scene.fluid || !kind.is_free() || scene.gravity.norm() == 0) return;
  const double diameter = std::cbrt(6 / std::numbers::pi * volume), nu = scene.fluid->kinematic_viscosity;
  const double speed = terminal_velocity(diameter, kind.density, scene.gravity.norm(), nu);
  table.quantity("  terminal velocity", speed, dimension::velocity, "m/s",
                 "cells/step (sphere of its volume, unbounded)");
  table.line("  its Reynolds, Mach", "",
             fmt::format("{}, {}", shown(speed * diameter / nu), shown(speed * std::sqrt(3.))));
}

/// As many as asked for, else as there are sites, of which some may turn out not to be free.
std::uint64_t most_bodies_of(const Case& scene, std::size_t fill) {
  const FillSpec& spec = scene.fills[fill];
  if (spec.count > 0) return static_cast<std::uint64_t>(spec.count);
  return lattice_of(scene, fill, rigid::bounding_radius(scene.shapes[spec.shape])).total();
}

/// What of the box, as far as it lies in the domain, is left for the bodies' centres.
void add_room(const Case& scene, Table& table, std::size_t fill) {
  const FillSpec& spec = scene.fills[fill];
  const double radius = rigid::bounding_radius(scene.shapes[spec.shape]);
  const rigid::BoundingBox room = room_for_centres(scene, fill, radius);
  double share = scene.walls.empty() ? 1 : CurvedWalls(scene).share_left(room, radius + spec.gap);
  for (int d = 0; d < 3; ++d) {
    const double length = scene.cells[d];
    const double box = scene.periodic(d) ? std::min(spec.upper[d] - spec.lower[d], length)
                                         : std::min(spec.upper[d], length) - std::max(spec.lower[d], 0.);
    share *= (room.upper[d] - room.lower[d]) / box;
  }
  table.line("  room for centres",
             fmt::format("{:.0f} % of the box: its faces and walls take the rest", 100 * share));
}

/// How often a fill is applied again, and what that comes to if there is always room.
void add_inflow(const Case& scene, Table& table, const FillSpec& fill, double count) {
  if (fill.every == 0) return;
  const double last = std::min(fill.until, static_cast<double>(scene.steps - 1));
  const auto again = static_cast<std::int64_t>(last / static_cast<double>(fill.every));
  table.line("  again", fmt::format("every {} steps, {} time{}", fill.every, again, again == 1 ? "" : "s"));
  const double a_step = count / static_cast<double>(fill.every);
  const double mass = a_step * fill.density * rigid::mass_properties(scene.shapes[fill.shape]).volume;
  table.quantity("  bodies at most", a_step, {0, -1, 0}, "a second", "a step");
  table.quantity("  their mass", mass, {0, -1, 1}, "kg/s", "a step");
}

void add_bodies(const Case& scene, Table& table) {
  if (!scene.has_bodies()) {
    table.heading("bodies: none");
    return;
  }
  table.heading("bodies");
  if (scene.gravity.norm() > 0)
    table.quantity("gravity", scene.gravity.norm(), dimension::acceleration, "m/s2", "cells/step2");
  double volume = 0;
  const std::vector<Entry> entries = entries_of(scene);
  const std::size_t given = entries.size() - scene.fills.size();
  constexpr std::size_t most_lines = 12;
  for (std::size_t i = 0; i < std::min(given, most_lines); ++i) {
    add_kind(scene, table, entries[i].key, entries[i]);
    for (const FiledBodies& filed : scene.filed)
      if (entry_key(filed.alike.entry) == entries[i].key && filed.positions.dataset.empty())
        table.line("  in " + filed.positions.file,
                   lines_text(filed.contents.points, filed.contents.headings));
  }
  if (given > most_lines) table.line("", fmt::format("and {} more entries", given - most_lines));
  for (std::size_t i = 0; i < entries.size(); ++i) {
    Entry entry = entries[i];
    if (i >= given) {
      const FillSpec& fill = scene.fills[i - given];
      entry.count = most_bodies_of(scene, i - given);
      add_kind(scene, table, fmt::format("{} {}", entry.key, scene.kind_names[fill.kind]), entry);
      add_room(scene, table, i - given);
      add_inflow(scene, table, fill, static_cast<double>(entry.count));
    }
    volume += static_cast<double>(entry.count) * rigid::mass_properties(scene.shapes[entry.shape]).volume;
  }
  for (std::size_t i = 0; i < scene.outflows.size(); ++i)
    table.line(fmt::format("outflow[{}]", i),
               fmt::format("{} to {}", shown_point(scene, scene.outflows[i].lower),
                           shown_point(scene, scene.outflows[i].upper)));
  const double cells = 1. * scene.cells[0] * scene.cells[1] * scene.cells[2];
  table.line("volume fraction", fmt::format("{:.2f} %", 100 * volume / cells));
  table.line("collision backend", scene.contacts.backend);
  table.line("broad phase", scene.contacts.broad_phase);
  table.line("contact resolver", scene.contacts.resolver);
  if (const auto rule = sleep_rule(scene)) {
    table.quantity("sleep, no faster than", rule->speed, dimension::velocity, "m/s", "cells a step");
    table.quantity("sleep, for", rule->steps, dimension::time, "s", "steps");
  }
  if (scene.fluid) table.line("lubrication", scene.has_lubrication() ? "on" : "off");
}

void add_run(const Case& scene, Table& table) {
  table.heading("run");
  table.quantity("length", static_cast<double>(scene.steps), dimension::time, "s", "steps");
  const OutputSpec& output = scene.output;
  const auto series = [&](const std::string& name, std::int64_t every, bool at_start) {
    if (every <= 0) return;
    const std::int64_t times = (scene.steps - 1) / every + 1 + at_start;
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

double fluid_memory(const Case& scene) {
  if (!scene.fluid) return 0;
  const double cells = 1. * scene.cells[0] * scene.cells[1] * scene.cells[2];
  return cells * (populations * (scene.fluid->precision == Precision::double_ ? 8 : 4) +
                  (scene.has_surfaces() ? 1 : 0));
}

std::string derived_table(const Case& scene) {
  Table table(scene);
  if (!scene.title.empty()) table.heading(scene.title);
  add_domain(scene, table);
  add_fluid(scene, table);
  add_bodies(scene, table);
  add_run(scene, table);
  return table.text;
}

}  // namespace silt::coupler
