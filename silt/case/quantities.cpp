// [[quantities]], with their checks.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "silt/case/case_sections.hpp"

namespace silt {
namespace {

/// A key for those types that take it.
template <class AnyKey>
struct KeyOf {
  Q::Key taken;
  AnyKey key;
};

constexpr std::tuple every_type_keys{
    HandKey{"name", "string", "", required, "name of the quantity in report.json"},
    HandKey{"type", "type of quantity", "", required,
            "one of those listed in cases/README.md, with its other keys"},
    HandKey{"over", "[from, to]", "s", "none",
            "for types that have a value in every step: their mean from one time to another"},
    HandKey{"deviation", "boolean", "", "false", "with over: the standard deviation instead of the mean"}};
constexpr std::tuple type_keys{
    KeyOf{Q::Key(Q::body | Q::bearer), HandKey{"body", "string", "", "every body",
                                               "kind of bodies: name of a [[bodies]] or [[fill]] entry"}},
    KeyOf{Q::axis, Key{"axis", &QuantitySpec::axis, Choice{axis_names},
                       "axis along which the quantity is taken", "\"z\""}},
    KeyOf{Q::Key(Q::time | Q::instant),
          Key{"time", &QuantitySpec::time, Number{dimension::time, range::at_least(0)},
              "time from which the quantity is evaluated; of kinetic-energy and dissipation: time of the "
              "evaluation",
              "–, the end"}},
    KeyOf{Q::height, Key{"height", &QuantitySpec::height, Number{dimension::length},
                         "coordinate along the axis that bodies pass", required}},
    KeyOf{Q::centre, Key{"centre", &QuantitySpec::centre, Vector{dimension::length},
                         "a point of the container's axis, [x, y, z]", required}},
    KeyOf{Q::box, Key{"box", &QuantitySpec::box, Corners{}, "two corners", "the domain"}},
    KeyOf{Q::component, Key{"component", &QuantitySpec::component, Choice{component_names},
                            "component of the stress", required}},
    KeyOf{Q::Key(Q::side | Q::side_bears),
          Key{"side", &QuantitySpec::side, Choice{coupler::side_names},
              "side of the domain, for example \"z-low\"; of forces instead of body", "–, none"}},
    KeyOf{Q::Key(Q::at | Q::planes),
          HandKey{"at", "number, [first, second]", "m", required,
                  "position of the plane along the axis; of a pressure-drop both planes"}},
    KeyOf{Q::Key(Q::wall | Q::bearer),
          HandKey{"wall", "string", "", "the only one, none",
                  "name of one of [[walls]]; of forces and torques instead of body"}}};

void read_wall(TableReader& table, QuantitySpec& quantity, const Case& setup) {
  std::vector<std::string> names;
  for (const CurvedWall& wall : setup.walls) names.push_back(wall.name);
  quantity.wall = read_name(table, "wall", names, "wall").value_or(0);
  if (names.size() != 1)
    table.need("wall", names.empty() ? "the name of one of [[walls]], of which there is none"
                                     : "the name of one of [[walls]]: " + joined(names));
}

/// Reads one of body, wall and, if the type takes it, side.
void read_bearer(TableReader& table, const QuantityType& type, QuantitySpec& quantity, const Case& setup) {
  std::string given;
  for (const auto& [key, bearer] : {std::pair("body", Bearer::bodies), std::pair("wall", Bearer::wall),
                                    std::pair("side", Bearer::side)}) {
    if ((bearer == Bearer::side && !type.takes(Q::side_bears)) || !table.has(key)) continue;
    if (!given.empty())
      table.fail(key, "{} and {} are both given; a force acts on one of them: keep one", table.path(given),
                 table.path(key));
    given = key;
    quantity.bearer = bearer;
  }
  if (quantity.bearer == Bearer::wall) read_wall(table, quantity, setup);
}

/// One plane across the axis, or two.
void read_planes(TableReader& table, const QuantityType& type, QuantitySpec& quantity) {
  if (type.takes(Q::at)) quantity.height = table.quantity("at", dimension::length, range::any).value_or(0);
  const Node* const node = type.takes(Q::planes) ? table.find("at") : nullptr;
  if (!node) return;
  const auto at = node->numbers(2);
  if (!at || (*at)[0] == (*at)[1])
    return table.refuse("at", "the places of two planes along the axis, [first, second], which differ");
  const double cell = table.context().units.cell_size;
  quantity.height = (*at)[0] / cell, quantity.second_height = (*at)[1] / cell;
}

/// The steps of which the value is the mean or the deviation.
void read_over(TableReader& table, const QuantityType& type, QuantitySpec& quantity) {
  const bool deviation = table.boolean("deviation").value_or(false);
  const Node* const node = table.find("over");
  if (!node)
    return table.refuse_given({"deviation"}, "{key} is given without {table}.over, which gives the times");
  if (!type.asks_for(Q::stepwise))
    return table.fail("over", "{} is given, but \"{}\" has no value in every step; remove the key",
                      table.path("over"), type.name);
  if (type.takes(Q::time))
    table.refuse_given({"time"},
                       "{key} and {table}.over are both given; both give the times of the mean, keep one");
  const auto times = node->numbers(2);
  if (!times || !((*times)[0] >= 0 && (*times)[0] < (*times)[1]))
    return table.refuse("over", "two times, [from, to], the first at least 0 and before the second");
  const double step = table.context().units.time_step;
  quantity.over = {(*times)[0] / step, (*times)[1] / step, deviation};
}

// The keys that the type takes; any other is unknown.
void read_quantity_keys(TableReader& table, const QuantityType& type, QuantitySpec& quantity,
                        const Case& setup) {
  if (type.takes(Q::instant)) quantity.time = std::numeric_limits<double>::infinity();  // the end
  const auto read = [&](const auto& row) {
    if (type.takes(row.taken)) read_key(table, quantity, row.key);
  };
  std::apply([&](const auto&... row) { (read(row), ...); }, type_keys);
  read_over(table, type, quantity);
  if (type.takes(Q::time) && !table.has("over"))
    table.need("time", "time from which the quantity is evaluated");
  read_planes(table, type, quantity);
  if (type.takes(Q::side)) table.need("side", "side of the domain, for example \"z-low\"");
  if (type.takes(Q::Key(Q::body | Q::bearer)))
    quantity.kind = read_name(table, "body", setup.kind_names, "name of [[bodies]] or [[fill]]").value_or(-1);
  if (type.takes(Q::wall)) read_wall(table, quantity, setup);
  if (type.takes(Q::bearer)) read_bearer(table, type, quantity, setup);
}

// Returns what a quantity needs and the case lacks.
std::string lacking(const Case& setup, const QuantityType& type) {
  if (type.asks_for(Q::fluid) && !setup.fluid) return "the case has no [fluid]";
  if (type.asks_for(Q::heat) && !setup.heat) return "the case has no [heat]";
  if (type.asks_for(Q::bodies) && !setup.has_bodies()) return "the case has no bodies";
  if (type.asks_for(Q::gravity) && setup.gravity.norm() == 0) return "the case has no [gravity]";
  const bool driven =
      setup.any_given([](const BodySpec& b) { return b.motion == rigid::Motion::prescribed; });
  if (type.asks_for(Q::same_bodies) && (setup.bodies_come() || setup.bodies_leave()))
    return "bodies enter or leave, which it does not account for";
  if (setup.start && (type.asks_for(Q::same_bodies) || type.name == "drift" || type.name == "displacement"))
    return "bodies come from another run (initial.from), so that their first places are unknown";
  if (type.asks_for(Q::undriven) && driven)
    return "the case has a body of prescribed motion, which drives the others";
  return "";
}

/// Checks that the bearer of a force exists and can bear it.
void check_bearer(const Case& setup, Diagnostics& findings, const QuantitySpec& quantity,
                  const std::string& entry) {
  const bool of_fluid = quantity_type(quantity.type).asks_for(Q::fluid);
  const coupler::BoundarySpec& side = setup.boundary[quantity.side];
  if (quantity.bearer == Bearer::bodies && !setup.has_bodies())
    findings.error(entry + ".type",
                   "{}.type is \"{}\", but the case has no bodies; name a wall or a side that bears it",
                   entry, quantity.type);
  if (quantity.bearer == Bearer::side && !of_fluid && !side.stops_bodies())
    findings.error(entry + ".side", "{}.side is {}, which bodies do not touch; it must be solid for them",
                   entry, side_key(quantity.side));
}

/// Checks the place of a quantity: a side, an axis, a box.
void check_place(const Case& setup, Diagnostics& findings, const QuantitySpec& quantity,
                 const std::string& entry) {
  const QuantityType& type = quantity_type(quantity.type);
  const bool is_led = type.asks_for(Q::heat) && setup.heat && setup.heat->gradient[quantity.side / 2] != 0;
  if ((type.takes(Q::side) || quantity.bearer == Bearer::side) && type.asks_for(Q::fluid) && !is_led &&
      !setup.boundary[quantity.side].is_wall())
    findings.error(entry + ".side",
                   "{}.side is {}, which is no wall; it must be a side that is no-slip or moving", entry,
                   side_key(quantity.side));
  const coupler::BoundarySpec &low = setup.boundary[2 * quantity.axis],
                              &high = setup.boundary[2 * quantity.axis + 1];
  if (type.asks_for(Q::sheared) && !(low.is_wall() && high.is_wall() && low.velocity != high.velocity))
    findings.error(entry + ".axis",
                   "{}.axis is {}, across which nothing is sheared; both sides there must be walls (no-slip "
                   "or moving), of different velocities",
                   entry, "xyz"[quantity.axis]);
  else if (type.asks_for(Q::sheared) && (low.over_time.amplitude != 0 || high.over_time.amplitude != 0))
    findings.warning(
        entry + ".type",
        "{}.type is \"{}\", but a wall oscillates: where the walls are as fast as one another the "
        "quantity is infinite, and its mean says nothing; use \"wall-stress\" in [[output.series]]",
        entry, quantity.type);
  if (type.takes(Q::bearer)) check_bearer(setup, findings, quantity, entry);
  const int cells = setup.cells[quantity.axis];
  for (const double at : {quantity.height, quantity.second_height})
    if (type.takes(Q::Key(Q::at | Q::planes)) && !(at >= 0 && at <= cells))
      findings.error(entry + ".at", "{}.at is {}; it must lie in the domain, 0 to {} along {}", entry,
                     shown_length(setup, at), shown_length(setup, cells), "xyz"[quantity.axis]);
  const auto& [lower, upper] = quantity.box;
  for (int d = 0; type.takes(Q::box) && d < 3; ++d)
    if (lower[d] < 0 || upper[d] > setup.cells[d])
      return findings.error(entry + ".box",
                            "{}.box reaches from {} to {} along {}; it must lie in the domain, 0 to {}",
                            entry, shown_length(setup, lower[d]), shown_length(setup, upper[d]), "xyz"[d],
                            shown_length(setup, setup.cells[d]));
}

/// The columns of series_NAME.csv and of tables of sweeps other than quantities.
constexpr std::string_view columns_of_tables[] = {"step",        "time",  "folder",
                                                  "exit_reason", "steps", "wall_seconds"};

}  // namespace

std::vector<KeySection> quantity_sections() {
  KeySection section = section_of("quantities", every_type_keys);
  std::apply([&](const auto&... row) { (section.keys.push_back(text_of(row.key)), ...); }, type_keys);
  return {section};
}

void read_quantities(TableReader& root, Case& setup) {
  std::vector<std::string> names;
  for (TableReader& table : root.tables("quantities")) {
    QuantitySpec quantity;
    quantity.box = box_of(setup);
    read_keys(table, quantity, every_type_keys);
    quantity.name = read_new_name(table, names, "quantity");
    std::vector<std::string> types;
    for (const QuantityType& known : quantity_types) types.emplace_back(known.name);
    const auto type = table.choice("type", types);
    if (!type) table.judge_no_keys();
    if (!type) continue;
    quantity.type = *type;
    read_quantity_keys(table, quantity_type(*type), quantity, setup);
    quantity.box.upper = snapped(quantity.box.upper, setup.cells);
    if (quantity_type(*type).takes(Q::at))
      quantity.height = snapped(quantity.height, setup.cells[quantity.axis]);
    setup.quantities.push_back(quantity);
  }
}

void find_quantity_faults(const Case& setup, Diagnostics& findings) {
  for (std::size_t i = 0; i < setup.quantities.size(); ++i) {
    const QuantitySpec& quantity = setup.quantities[i];
    const QuantityType& type = quantity_type(quantity.type);
    const std::string entry = fmt::format("quantities[{}]", i), lack = lacking(setup, type);
    if (std::ranges::find(columns_of_tables, quantity.name) != std::end(columns_of_tables))
      findings.error(
          entry + ".name",
          "{}.name is '{}', and tables of results have a column of that name already; choose another", entry,
          quantity.name);
    const auto end = static_cast<double>(setup.steps);
    if (!lack.empty())
      findings.error(entry + ".type", "{}.type is \"{}\", but {}", entry, quantity.type, lack);
    if (quantity.over && quantity.over->from > end)
      findings.warning(entry + ".over",
                       "{}.over begins after the end of the run: the quantity will have no value", entry);
    else if (quantity.over && quantity.over->to > end + 0.5)
      findings.warning(
          entry + ".over",
          "{}.over ends at {}, after the end of the run at {}: the quantity is evaluated up to there only",
          entry, shown(setup.units.physical(quantity.over->to, dimension::time)),
          shown(setup.units.physical(end, dimension::time)));
    if ((type.takes(Q::time) && quantity.time >= end) ||
        (type.takes(Q::instant) && std::isfinite(quantity.time) && quantity.time > end))
      findings.warning(entry + ".time",
                       "{}.time is not before the end of the run: the quantity will have no value", entry);
    check_place(setup, findings, quantity, entry);
  }
}

}  // namespace silt
