// [run], [output], [[quantities]]
#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <limits>

#include "coupler/case/case_sections.hpp"
#include "coupler/case/quantity_types.hpp"

namespace silt::coupler {
namespace {

void read_series(TableReader& series, SeriesSpec& spec) {
  if (!series.present()) return;
  if (!series.has("every")) series.missing("every", "the number of steps between two writes (0: never)");
  spec.every = series.integer("every", 0).value_or(0);
}

double read_length(TableReader& table, const char* key, const char* what) {
  if (!table.has(key)) table.missing(key, what);
  return table.quantity(key, dimension::length, range::any).value_or(0);
}

void read_field_names(TableReader& fields, std::vector<Field>& quantities) {
  const std::vector<std::string> known = field_names.list();
  const Node* list = fields.find("quantities");
  if (!list) return;
  const bool strings = list->kind == Node::Kind::array && !list->children.empty() &&
                       std::all_of(list->children.begin(), list->children.end(),
                                   [](const Node& n) { return n.kind == Node::Kind::string; });
  if (!strings) {
    fields.refuse("quantities", "a list out of " + joined(known));
    return;
  }
  quantities.clear();
  for (const Node& name : list->children)
    if (const int i = index_of(fields, "quantities", name.string, known, "quantity"); i >= 0)
      quantities.push_back(Field(i));
}

void read_fields(TableReader& table, FieldsSpec& fields) {
  if (!table.present()) return;
  read_series(table, fields);
  read_field_names(table, fields.quantities);
  fields.double_precision = table.choice("precision", {"single", "double"}).value_or("single") == "double";
  fields.compression = static_cast<int>(table.integer("compression", 0, 9).value_or(0));
}

// VTK 9.1 and ParaView 5.11 end with SIGABRT on an image one point thick.
constexpr int least_layers = 2;

/// The two layers of cells between whose centres a plane lies; at a side of the domain the two beside it.
void read_plane(TableReader& table, FieldsSpec& slice) {
  const int axis = table.choice("axis", {"x", "y", "z"}).value_or("x")[0] - 'x';
  const double at = read_length(table, "at", "where the plane is along the axis");
  const int cells = slice.upper[axis];
  if (!(at >= 0 && at <= cells)) return table.refuse("at", "within the domain");
  if (cells < least_layers) return;
  slice.lower[axis] = std::clamp(int(std::floor(at - 0.5)), 0, cells - least_layers);
  slice.upper[axis] = slice.lower[axis] + least_layers;
}

/// The cells whose centres are in a box.
void read_cells(TableReader& table, FieldsSpec& slice) {
  rigid::Vec3 lower, upper;
  read_box(table, slice.upper, lower, upper);
  for (int d = 0; d < 3; ++d) {
    const int least = std::min(least_layers, slice.upper[d]);
    slice.lower[d] = int(std::ceil(std::clamp(lower[d], 0., double(slice.upper[d])) - 0.5));
    slice.upper[d] = int(std::floor(std::clamp(upper[d], 0., double(slice.upper[d])) - 0.5)) + 1;
    if (slice.upper[d] - slice.lower[d] < least)
      return table.refuse("box", "one that holds the centres of two cells along each axis or more");
  }
}

/// Names become those of files.
bool is_file_name(const std::string& name) {
  return !name.empty() && name.size() <= 64 && std::all_of(name.begin(), name.end(), [](unsigned char c) {
    return std::isalnum(c) || c == '-' || c == '.';
  });
}

void read_slices(TableReader& output, const std::array<int, 3>& cells, std::vector<FieldsSpec>& slices) {
  for (TableReader& table : output.tables("slices")) {
    FieldsSpec slice;
    if (!table.has("name")) table.missing("name", "of its files, slice_NAME_*.hdf");
    const std::string name = table.string("name").value_or("");
    if (table.has("name") && !is_file_name(name))
      table.refuse("name", "up to 64 letters, digits, dots and hyphens");
    slice.name = "slice_" + name;
    for (const FieldsSpec& other : slices)
      if (other.name == slice.name)
        table.fail("name", fmt::format("{}: there already is a slice '{}'", table.path("name"), name));
    slice.upper = cells;
    read_fields(table, slice);
    if (table.has("axis") && table.has("box")) table.fail("box", "a slice has a plane (axis, at) or a box");
    if (table.has("axis"))
      read_plane(table, slice);
    else
      read_cells(table, slice);
    slices.push_back(slice);
  }
}

std::vector<std::string> type_names() {
  std::vector<std::string> names;
  for (const QuantityType& type : quantity_types) names.emplace_back(type.name);
  return names;
}

void read_profile(TableReader& table, QuantitySpec& quantity) {
  if (!table.has("profile")) table.missing("profile", "channel, duct or pipe");
  quantity.profile = table.choice("profile", profile_names).value_or(quantity.profile);
}

void read_time(TableReader& table, QuantitySpec& quantity) {
  if (!table.has("time")) table.missing("time", "from when on");
  quantity.time = table.quantity("time", dimension::time, range::at_least(0)).value_or(0);
}

// The end of the run without it.
double read_instant(TableReader& table) {
  constexpr double the_end = std::numeric_limits<double>::infinity();
  return table.quantity("time", dimension::time, range::at_least(0)).value_or(the_end);
}

void read_centre(TableReader& table, QuantitySpec& quantity) {
  if (!table.has("centre")) table.missing("centre", "a point of the container's axis, [x, y, z]");
  quantity.centre = table.vector("centre", dimension::length).value_or(quantity.centre);
}

void read_side(TableReader& table, QuantitySpec& quantity) {
  if (!table.has("side")) table.missing("side", "of the domain, \"z-low\" for one");
  quantity.side = static_cast<int>(table.choice("side", side_names).value_or(Side::x_low));
}

void read_wall(TableReader& table, QuantitySpec& quantity, const QuantityScope& scope) {
  std::vector<std::string> names;
  for (const CurvedWall& wall : scope.walls) names.push_back(wall.name);
  const auto name = table.string("wall");
  if (name)
    quantity.wall = std::max(0, index_of(table, "wall", *name, names, "wall"));
  else if (names.size() != 1 && !table.has("wall"))
    table.missing("wall", names.empty() ? "the name of one of [[walls]], of which there is none"
                                        : "the name of one of [[walls]]: " + joined(names));
}

// The keys that the type takes; any other is unknown.
void read_quantity_keys(TableReader& table, const QuantityType& type, QuantitySpec& quantity,
                        const QuantityScope& scope) {
  using Q = QuantityType;
  if (type.takes(Q::body))
    if (const auto body = table.string("body"))
      quantity.kind = index_of(table, "body", *body, scope.kind_names, "name of [[bodies]] or [[fill]]");
  if (type.takes(Q::axis)) quantity.axis = table.choice("axis", {"x", "y", "z"}).value_or("z")[0] - 'x';
  if (type.takes(Q::profile)) read_profile(table, quantity);
  if (type.takes(Q::time)) read_time(table, quantity);
  if (type.takes(Q::instant)) quantity.time = read_instant(table);
  if (type.takes(Q::height)) quantity.height = read_length(table, "height", "what bodies are to fall below");
  if (type.takes(Q::centre)) read_centre(table, quantity);
  if (type.takes(Q::side)) read_side(table, quantity);
  if (type.takes(Q::wall)) read_wall(table, quantity, scope);
  if (type.takes(Q::box)) read_box(table, scope.cells, quantity.lower, quantity.upper);
}

void read_steady(TableReader steady, std::optional<SteadySpec>& found) {
  if (!steady.present()) return;
  SteadySpec& spec = found.emplace();
  if (!steady.has("quantity")) steady.missing("quantity", "the name of one of [[quantities]]");
  if (!steady.has("change"))
    steady.missing("change", "how much of the quantity may still be missing at the end, as in 1e-4");
  if (!steady.has("every")) steady.missing("every", "the number of steps between two looks");
  spec.quantity = steady.string("quantity").value_or("");
  spec.change = steady.number("change", {0, 1, false, false}).value_or(1);
  spec.every = steady.integer("every", 1).value_or(1);
}

}  // namespace

void read_run(TableReader& root, std::int64_t& steps, std::optional<SteadySpec>& steady,
              std::int64_t& balance_every) {
  if (!root.has("run")) root.missing("run", "a table [run] with steps or time");
  TableReader run = root.table("run");
  if (!run.present()) return;
  const std::string given = run.one_of({"steps", "time"}, true, "how long the run is");
  if (given == "steps") {
    steps = run.integer("steps", 1).value_or(1);
  } else if (given == "time") {
    constexpr double most_steps = 1e15;
    const double wanted = run.quantity("time", dimension::time, range::above(0)).value_or(1);
    if (root.context().units_known && !(wanted < most_steps))
      run.refuse("time", fmt::format("less than {} steps of {}", shown(most_steps),
                                     shown(root.context().units.time_step)));
    else
      steps = std::max<std::int64_t>(1, std::llround(wanted));
  }
  read_steady(run.table("steady"), steady);
  TableReader balance = run.table("balance");
  if (!balance.present()) return;
  if (!balance.has("every")) balance.missing("every", "the number of steps between two looks (0: never)");
  balance_every = balance.integer("every", 0).value_or(0);
}

void read_output(TableReader& root, const std::array<int, 3>& cells, OutputSpec& output) {
  TableReader table = root.table("output");
  output.fields.upper = cells;
  if (!table.present()) return;
  TableReader fields = table.table("fields"), bodies = table.table("bodies");
  TableReader checkpoint = table.table("checkpoint"), report = table.table("report");
  read_fields(fields, output.fields);
  read_slices(table, cells, output.slices);
  read_series(bodies, output.bodies);
  output.body_contacts = bodies.boolean("contacts").value_or(false);
  read_series(checkpoint, output.checkpoint);
  read_series(report, output.report);
  output.keep_checkpoints =
      static_cast<int>(checkpoint.integer("keep", 1, 1000).value_or(output.keep_checkpoints));
}

void read_quantities(TableReader& root, const QuantityScope& scope, std::vector<QuantitySpec>& quantities) {
  std::vector<std::string> names;
  for (TableReader& table : root.tables("quantities")) {
    QuantitySpec quantity;
    if (!table.has("name")) table.missing("name", "what report.json calls the quantity");
    if (!table.has("type")) table.missing("type", "one of " + joined(type_names()));
    quantity.name = table.string("name").value_or("");
    if (!quantity.name.empty() && std::count(names.begin(), names.end(), quantity.name))
      table.fail("name",
                 fmt::format("{}: there already is a quantity '{}'", table.path("name"), quantity.name));
    names.push_back(quantity.name);
    const auto type = table.choice("type", type_names());
    if (!type) table.judge_no_keys();
    if (!type) continue;
    quantity.type = *type;
    read_quantity_keys(table, quantity_type(*type), quantity, scope);
    quantities.push_back(quantity);
  }
}

}  // namespace silt::coupler
