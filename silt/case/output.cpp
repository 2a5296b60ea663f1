// [run] and [output], with their checks.
#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <cmath>

#include "silt/case/case_sections.hpp"

namespace silt {
namespace {

constexpr double most_steps = 1e15;
constexpr coupler::NameTable<Device, device_names.size()> device_table{device_names};

constexpr std::tuple run_keys{
    Key{"steps", &Case::steps, Whole{1}, "length of the run in steps, at most", "one of two"},
    HandKey{"time", "number", "s", "one of two", "length of the run, at most"},
    HandKey{"steady", "table", "", "none", "ends the run earlier, when a quantity has become steady"},
    HandKey{"balance", "table", "", "none",
            "checks at intervals whether another cut of the domain shares the work better",
            IdleInCase{[](const Case& setup) { return setup.balance_every > 0 && setup.block_cells; },
                       "domain.blocks says how the domain is cut; remove one of them"}},
    Key{"device", &Case::device, Choice{device_table},
        "where the passes of the fluid run: on the processor, on a graphics processor, or (\"host\") as on "
        "one but on the processor",
        nullptr,
        IdleInCase{[](const Case& setup) { return !setup.fluid && setup.device != Device::cpu; },
                   "the case has no [fluid], whose passes it is about; remove it"}}};
constexpr std::tuple steady_keys{
    Key{"quantity", &SteadySpec::quantity, Text{}, "the name of one of [[quantities]]", required},
    Key{"change", &SteadySpec::change, Number{dimension::none, {0, 1, false, false}},
        "largest remaining change of the quantity, as a share of its value, between 0 and 1, as in 1e-4",
        required},
    Key{"every", &SteadySpec::every, Whole{1}, "the number of steps between two checks", required}};
constexpr std::tuple balance_keys{Key{"every", &Case::balance_every, Whole{0},
                                      "the number of steps between two checks of the load balance (0: never)",
                                      required}};

constexpr std::tuple output_keys{
    HandKey{"fields", "table", "", "none", "fields of the fluid, fields_*.hdf"},
    HandKey{"slices", "list of tables", "", "none", "fields of parts of the domain, slice_*.hdf"},
    HandKey{"series", "list of tables", "", "none", "values of quantities over time, series_*.csv"},
    HandKey{"probes", "list of tables", "", "none",
            "fields of the fluid at points and on lines over time, probes_*.csv"},
    HandKey{"mean", "table", "", "none", "means and covariances of the fluid over time, mean_*.hdf"},
    HandKey{"bodies", "table", "", "none", "series of the bodies, bodies.h5"},
    HandKey{"checkpoint", "table", "", "none", "checkpoints, checkpoint_*.h5"},
    HandKey{"report", "table", "", "none",
            "report.json and a row of series.csv during the run; at the end the report is always written"}};
constexpr std::tuple series_keys{Key{"every", &SeriesSpec::every, Whole{.unit = "steps"},
                                     "the number of steps between two writes (0: never)", required}};
/// A table that is never written makes its other keys idle.
constexpr Rule if_written{If::idle, is_zero(&SeriesSpec::every), "{table}.every is 0: it is never written"};
constexpr std::tuple field_keys{
    HandKey{"quantities", "list of fields", "", "velocity, density",
            "\"velocity\", \"density\", \"pressure\", \"shear-rate\", \"vorticity\", \"body-id\", "
            "\"temperature\"; \"solid\" "
            "comes by itself: OUTPUT.md",
            if_written},
    Key{"precision", &FieldsSpec::double_precision, Choice{coupler::names_of<bool>("single", "double")},
        "of the numbers in the files", nullptr, if_written}};
constexpr std::tuple slice_keys{
    HandKey{"name", "string", "", required, "name in its files, slice_NAME_*.hdf"},
    HandKey{"box", "[[x, y, z], [x, y, z]]", "m", required,
            "lower and upper corner, equal along the axis normal to a plane"}};
constexpr std::tuple columns_keys{
    HandKey{"name", "string", "", required, "name in its file, series_NAME.csv"},
    Key{"every", &SeriesSpec::every, Whole{.low = 1, .unit = "steps"}, "the number of steps between two rows",
        required},
    HandKey{"columns", "list of strings", "", required, "names of [[quantities]]"},
    Key{"mean_of", &ColumnsSpec::mean_of, Whole{.low = 1, .unit = "steps"},
        "a row is the mean over this number of steps, up to its own: at most those since the last row"}};
constexpr std::tuple probe_keys{
    HandKey{"name", "string", "", required, "name in its file, probes_NAME.csv"},
    HandKey{"points", "[[x, y, z], …]", "m", "one of two", "positions of the points"},
    HandKey{"line", "[[x, y, z], [x, y, z]]", "m", "one of two", "ends of a line of points"},
    HandKey{"count", "integer", "", "–, none", "number of points of a line, including its ends"},
    Key{"every", &SeriesSpec::every, Whole{.low = 1, .unit = "steps"},
        "the number of steps between two samples", required},
    HandKey{"quantities", "list of fields", "", "velocity",
            "\"velocity\", \"density\", \"pressure\", \"shear-rate\", \"temperature\""}};
constexpr std::tuple mean_keys{Key{"from", &MeanSpec::from, Number{dimension::time, range::at_least(0)},
                                   "time of the first sample", required},
                               Key{"every", &MeanSpec::every, Whole{.low = 1, .unit = "steps"},
                                   "the number of steps between two samples", required}};
constexpr std::tuple contact_output_keys{
    Key{"contacts", &OutputSpec::body_contacts, Flag{},
        "whether contact_force and contact_torque are computed in every step and written", nullptr,
        Rule{If::idle, [](const OutputSpec& output) { return output.bodies.every == 0; },
             "{table}.every is 0: it is never written"}}};
constexpr std::tuple checkpoint_keys{
    Key{"keep", &OutputSpec::keep_checkpoints, Whole{1, 1000}, "number of checkpoints that are kept"}};

void read_field_names(TableReader& fields, const std::vector<std::string>& known,
                      std::vector<Field>& quantities) {
  if (fields.has("quantities")) quantities.clear();
  for (const int i : read_names(fields, "quantities", known, "quantity")) quantities.push_back(Field(i));
}

void read_fields(TableReader& table, FieldsSpec& fields) {
  if (!table.present()) return;
  read_keys(table, fields, series_keys);
  read_keys(table, fields, field_keys);
  read_field_names(table, field_names.list(), fields.quantities);
}

// VTK 9.1 and ParaView 5.11 abort (SIGABRT) on an image that is one point thick.
constexpr int least_layers = 2;

/// Sets the cells whose centres are in a box; for a flat box the two layers around it, or next to a side.
void read_cells(TableReader& table, FieldsSpec& slice) {
  const auto box = table.box("box", true);
  for (int d = 0; box && d < 3; ++d) {
    const double cells = slice.upper[d];
    const double low = snapped(box->lower[d], slice.upper[d]), high = snapped(box->upper[d], slice.upper[d]);
    const int most_lower = slice.upper[d] - least_layers;
    if (low == high && !(low >= 0 && low <= cells))
      return table.refuse("box", "within the domain where it is flat");
    if (low == high && most_lower < 0) continue;
    if (low == high) {
      slice.lower[d] = std::clamp(int(std::floor(low - 0.5)), 0, most_lower);
      slice.upper[d] = slice.lower[d] + least_layers;
      continue;
    }
    slice.lower[d] = int(std::ceil(std::clamp(low, 0., cells) - 0.5));
    slice.upper[d] = int(std::floor(std::clamp(high, 0., cells) - 0.5)) + 1;
    if (slice.upper[d] - slice.lower[d] < std::min<double>(least_layers, cells))
      return table.refuse("box", "one that holds the centres of two cells along each axis or more");
  }
}

/// Returns whether a name can be part of a file name.
bool is_file_name(const std::string& name) {
  return !name.empty() && name.size() <= 64 &&
         std::ranges::all_of(name, [](unsigned char c) { return std::isalnum(c) || c == '-' || c == '.'; });
}

/// Reads the name of an entry, which becomes part of a file name, e.g. of "slice_".
std::string read_file_name(TableReader& table, std::vector<std::string>& names, std::string_view what) {
  const std::string name = read_new_name(table, names, what);
  if (table.has("name") && !is_file_name(name))
    table.refuse("name", "up to 64 letters, digits, dots and hyphens");
  return fmt::format("{}_{}", what, name);
}

void read_slices(TableReader& output, const std::array<int, 3>& cells, std::vector<FieldsSpec>& slices) {
  std::vector<std::string> names;
  for (TableReader& table : output.tables("slices")) {
    FieldsSpec slice;
    read_keys(table, slice, slice_keys);
    slice.name = read_file_name(table, names, "slice");
    slice.upper = cells;
    read_fields(table, slice);
    read_cells(table, slice);
    slices.push_back(slice);
  }
}

void read_series(TableReader& output, std::vector<ColumnsSpec>& all) {
  std::vector<std::string> names;
  for (TableReader& table : output.tables("series")) {
    ColumnsSpec series;
    read_keys(table, series, columns_keys);
    series.name = read_file_name(table, names, "series");
    const Node* const list = table.find("columns");
    const auto columns = list ? list->strings() : std::nullopt;
    if (columns && !columns->empty())
      series.columns = *columns;
    else if (list)
      table.refuse("columns", "a list of names of [[quantities]]");
    all.push_back(series);
  }
}

void read_points(TableReader& table, std::vector<rigid::Vec3>& points) {
  const std::string given = table.one_of({"points", "line"}, true, "positions of the points");
  if (given == "points")
    points = table.points("points", 1, std::size_t(-1), "a list of points, [[x, y, z], ...]");
  if (given == "points")
    table.refuse_given({"count"}, "{key} is of a line; remove it, or give line instead of points");
  if (given != "line") return;
  constexpr std::int64_t most = 100'000;
  const auto ends = table.points("line", 2, 2, "the two ends of a line, [[x, y, z], [x, y, z]]");
  const auto count = table.integer("count", 2, most);
  if (!table.has("count")) table.need("count", "the number of points of a line, including its ends");
  for (std::int64_t k = 0; ends.size() == 2 && count && k < *count; ++k)
    points.push_back(ends[0] + double(k) / double(*count - 1) * (ends[1] - ends[0]));
}

void read_probes(TableReader& output, const std::array<int, 3>& cells, std::vector<ProbesSpec>& all) {
  std::vector<std::string> names, known = field_names.list();
  known.resize(known.size() - 3);  // without fields of cells only
  for (TableReader& table : output.tables("probes")) {
    ProbesSpec probes;
    read_keys(table, probes, probe_keys);
    probes.name = read_file_name(table, names, "probes");
    read_points(table, probes.points);
    for (rigid::Vec3& x : probes.points) x = snapped(x, cells);
    read_field_names(table, known, probes.quantities);
    all.push_back(probes);
  }
}

void read_length_of_run(TableReader& run, std::int64_t& steps) {
  const std::string given = run.one_of({"steps", "time"}, true, "how long the run is");
  if (given != "time") return;
  const double wanted = run.quantity("time", dimension::time, range::above(0)).value_or(1);
  const ReadContext& context = run.context();
  if (context.units_known && !(wanted < most_steps))
    run.refuse("time",
               fmt::format("less than {} steps of {}", shown(most_steps), shown(context.units.time_step)));
  else
    steps = std::max<std::int64_t>(1, std::llround(wanted));
}

void read_run(TableReader run, Case& setup) {
  read_keys(run, setup, run_keys);
  if (!run.present()) return;
  read_length_of_run(run, setup.steps);
  TableReader steady = run.table("steady"), balance = run.table("balance");
  if (steady.present()) read_keys(steady, setup.steady.emplace(), steady_keys);
  read_keys(balance, setup, balance_keys);
}

/// Returns the quantity that a key names, or null (reported).
const QuantitySpec* named_quantity(Diagnostics& findings, const std::string& key, const std::string& name) {
  std::vector<std::string> names;
  for (const QuantitySpec& quantity : findings.setup.quantities) {
    if (quantity.name == name) return &quantity;
    names.push_back(quantity.name);
  }
  findings.error(key, "{}: there is no quantity '{}' in [[quantities]]{}", key, name,
                 names.empty() ? "" : suggestion(name, names));
  return nullptr;
}

void check_steady(const Case& setup, Diagnostics& findings) {
  constexpr int looks_needed = 4;
  const auto& [name, change, every] = *setup.steady;
  named_quantity(findings, "run.steady.quantity", name);
  if (every > setup.steps / looks_needed)
    findings.warning("run.steady.every",
                     "run.steady.every is {}, of {} steps in all: there will be less than the {} looks it "
                     "takes to see that something is steady",
                     every, setup.steps, looks_needed);
}

/// Series need quantities that have a value in every step without waiting for ranks.
void check_series(const Case& setup, Diagnostics& findings) {
  for (std::size_t i = 0; i < setup.output.series.size(); ++i) {
    const ColumnsSpec& series = setup.output.series[i];
    const std::vector<std::string>& columns = series.columns;
    if (series.mean_of > series.every)
      findings.error(fmt::format("output.series[{}].mean_of", i),
                     "output.series[{}].mean_of is {}, and there are {} steps between two rows; it can be as "
                     "many at most",
                     i, series.mean_of, series.every);
    const std::string key = fmt::format("output.series[{}].columns", i);
    for (std::size_t k = 0; k < columns.size(); ++k) {
      if (std::count(columns.begin(), columns.begin() + std::ptrdiff_t(k), columns[k]) > 0)
        findings.error(key, "{} has '{}' twice; keep one", key, columns[k]);
      const QuantitySpec* const q = named_quantity(findings, key, columns[k]);
      if (q && !quantity_type(q->type).asks_for(QuantityType::stepwise))
        findings.error(key,
                       "{} has '{}', which is of the type \"{}\" and has no value in each step; take it out, "
                       "and find it in series.csv with output.report",
                       key, columns[k], q->type);
    }
  }
}

void check_probes(const Case& setup, Diagnostics& findings) {
  for (std::size_t i = 0; i < setup.output.probes.size(); ++i) {
    const std::string key = fmt::format("output.probes[{}]", i);
    for (const rigid::Vec3& x : setup.output.probes[i].points)
      if (!lies_in_domain(setup, {x, x}, 0))
        return findings.error(key, "{} has the point {}; it must lie in the domain, {}", key,
                              shown_point(setup, x), shown_box(setup, box_of(setup)));
  }
}

/// Means need cells that stay on their ranks and levels.
void check_mean(const Case& setup, Diagnostics& findings) {
  if (!setup.output.mean) return;
  if (setup.coarsening)
    findings.error("output.mean",
                   "output.mean is of cells of one width, and the case has [coarsening]; remove one of them");
  if (setup.balance_every > 0)
    findings.error("output.mean",
                   "output.mean keeps cells on the ranks that have them, and run.balance moves them; remove "
                   "one of them");
  if (setup.output.mean->from > static_cast<double>(setup.steps))
    findings.warning("output.mean.from",
                     "output.mean.from is after the end of the run: there will be no sample");
}

}  // namespace

std::vector<KeySection> output_sections() {
  return {section_of("run", run_keys),
          section_of("run.steady", steady_keys),
          section_of("run.balance", balance_keys),
          section_of("output", output_keys),
          section_of("output.fields", series_keys, field_keys),
          section_of("output.slices", slice_keys, series_keys, field_keys),
          section_of("output.series", columns_keys),
          section_of("output.probes", probe_keys),
          section_of("output.mean", mean_keys),
          section_of("output.bodies", series_keys, contact_output_keys),
          section_of("output.checkpoint", series_keys, checkpoint_keys),
          section_of("output.report", series_keys)};
}

void read_output(TableReader& root, Case& setup) {
  read_run(root.table("run"), setup);
  OutputSpec& output = setup.output;
  TableReader table = root.table("output");
  output.fields.upper = setup.cells;
  read_keys(table, output, output_keys);
  if (!table.present()) return;
  TableReader fields = table.table("fields"), bodies = table.table("bodies");
  TableReader checkpoint = table.table("checkpoint"), report = table.table("report");
  read_fields(fields, output.fields);
  read_slices(table, setup.cells, output.slices);
  read_series(table, output.series);
  read_probes(table, setup.cells, output.probes);
  if (TableReader mean = table.table("mean"); mean.present())
    read_keys(mean, output.mean.emplace(), mean_keys);
  read_keys(bodies, output.bodies, series_keys);
  read_keys(bodies, output, contact_output_keys);
  read_keys(checkpoint, output.checkpoint, series_keys);
  read_keys(checkpoint, output, checkpoint_keys);
  read_keys(report, output.report, series_keys);
}

void find_run_faults(const Case& setup, Diagnostics& findings) {
  look_for_idle_keys(findings, "run.", run_keys);
  if (setup.steps < 1)
    findings.error("run.steps", "the run has {} steps; it must have at least 1", setup.steps);
  if (static_cast<double>(setup.steps) > most_steps)
    findings.error("run.steps", "the run has {} steps; at most {} are possible: shorten it", setup.steps,
                   shown(most_steps));
  if (setup.steady) check_steady(setup, findings);
  check_series(setup, findings);
  check_probes(setup, findings);
  check_mean(setup, findings);
  if (!setup.fluid && !setup.has_bodies())
    findings.error("", "the case has neither a [fluid] nor bodies: there is nothing to compute");
  const bool flat = std::ranges::find(setup.cells, 1) != setup.cells.end();
  if (setup.fluid && flat && (setup.output.fields.every > 0 || !setup.output.slices.empty()))
    findings.warning("output",
                     "the domain is one cell thick, and VTK and ParaView end with an error on fields as flat "
                     "as that: make domain.size two cells thick");
  for (const auto& [key, asked] : {std::pair("output.slices", !setup.output.slices.empty()),
                                   std::pair("output.probes", !setup.output.probes.empty()),
                                   std::pair("output.mean", setup.output.mean.has_value()),
                                   std::pair("output.fields", setup.output.fields.every > 0)})
    if (!setup.fluid && asked)
      findings.error(key, "{} asks for fields of the fluid, but the case has no [fluid]; remove it", key);
  if (!setup.has_bodies() && setup.output.bodies.every > 0)
    findings.warning("output.bodies", "output.bodies asks for bodies, but the case has none");
}

}  // namespace silt
