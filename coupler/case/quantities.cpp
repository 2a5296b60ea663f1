// [[quantities]], and what may be wrong with them.
#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <limits>

#include "coupler/case/case.hpp"
#include "coupler/case/case_check.hpp"
#include "coupler/case/case_sections.hpp"
#include "coupler/case/quantity_spec.hpp"
#include "rigid/shapes/shape.hpp"

namespace silt::coupler {

namespace {

using Q = QuantityType;

/// A key of those types that take it.
template <class AnyKey>
struct KeyOf {
  Q::Key taken;
  AnyKey key;
};

constexpr std::tuple every_type_keys{
    HandKey{"name", "string", "", required, "what report.json calls the quantity"},
    HandKey{"type", "type of quantity", "", required,
            "one of the table below, which says what else it takes"}};
constexpr std::tuple type_keys{
    KeyOf{Q::body, HandKey{"body", "string", "", "every body",
                           "kind of bodies: name of a [[bodies]] or [[fill]] entry"}},
    KeyOf{Q::axis, Key{"axis", &QuantitySpec::axis, Choice{axis_names},
                       "axis along which the quantity is taken", "\"z\""}},
    KeyOf{Q::time, Key{"time", &QuantitySpec::time, Number{dimension::time, range::at_least(0)},
                       "time from which on the quantity looks at the run", required}},
    KeyOf{Q::instant,
          Key{"time", &QuantitySpec::time, Number{dimension::time, range::at_least(0)},
              "of kinetic-energy and dissipation: when the quantity looks at the run", "the end"}},
    KeyOf{Q::height, Key{"height", &QuantitySpec::height, Number{dimension::length},
                         "coordinate along the axis that bodies are to pass", required}},
    KeyOf{Q::centre, Key{"centre", &QuantitySpec::centre, Vector{dimension::length},
                         "a point of the container's axis, [x, y, z]", required}},
    KeyOf{Q::box, HandKey{"box", "[[x, y, z], [x, y, z]]", "m", "the domain", "two corners"}},
    KeyOf{Q::profile,
          Key{"profile", &QuantitySpec::profile, Choice{profile_names},
              "analytic flow to compare with: channel, duct or pipe; of a pipe with its rotation", required}},
    KeyOf{Q::side, Key{"side", &QuantitySpec::side, Choice{side_names},
                       "side of the domain, \"z-low\" for one", required}},
    KeyOf{Q::wall, HandKey{"wall", "string", "", "the only one", "name of one of [[walls]]"}}};

std::vector<std::string> type_names() {
  std::vector<std::string> names;
  for (const QuantityType& type : quantity_types) names.emplace_back(type.name);
  return names;
}

void read_wall(TableReader& table, QuantitySpec& quantity, const Case& scene) {
  std::vector<std::string> names;
  for (const CurvedWall& wall : scene.walls) names.push_back(wall.name);
  const auto name = table.string("wall");
  if (name)
    quantity.wall = std::max(0, index_of(table, "wall", *name, names, "wall"));
  else if (names.size() != 1 && !table.has("wall"))
    table.missing("wall", names.empty() ? "the name of one of [[walls]], of which there is none"
                                        : "the name of one of [[walls]]: " + joined(names));
}

// The keys that the type takes; any other is unknown.
void read_quantity_keys(TableReader& table, const QuantityType& type, QuantitySpec& quantity,
                        const Case& scene) {
  if (type.takes(Q::instant)) quantity.time = std::numeric_limits<double>::infinity();  // the end
  const auto read = [&](const auto& row) {
    if (type.takes(row.taken)) read_key(table, quantity, row.key);
  };
  std::apply([&](const auto&... row) { (read(row), ...); }, type_keys);
  if (const auto body = type.takes(Q::body) ? table.string("body") : std::nullopt)
    quantity.kind = index_of(table, "body", *body, scene.kind_names, "name of [[bodies]] or [[fill]]");
  if (type.takes(Q::wall)) read_wall(table, quantity, scene);
  if (type.takes(Q::box)) read_box(table, scene.cells, quantity.lower, quantity.upper);
}

}  // namespace

std::vector<KeySection> quantity_sections() {
  KeySection section = section_of("quantities", every_type_keys);
  std::apply([&](const auto&... row) { (section.keys.push_back(text_of(row.key)), ...); }, type_keys);
  return {section};
}

void read_quantities(TableReader& root, Case& scene) {
  std::vector<std::string> names;
  for (TableReader& table : root.tables("quantities")) {
    QuantitySpec quantity;
    read_keys(table, quantity, every_type_keys);
    quantity.name = table.string("name").value_or("");
    if (!quantity.name.empty() && std::count(names.begin(), names.end(), quantity.name))
      table.fail("name", "{}: there already is a quantity '{}'", table.path("name"), quantity.name);
    names.push_back(quantity.name);
    const auto type = table.choice("type", type_names());
    if (!type) table.judge_no_keys();
    if (!type) continue;
    quantity.type = *type;
    read_quantity_keys(table, quantity_type(*type), quantity, scene);
    scene.quantities.push_back(quantity);
  }
}

namespace {

void check_sampled_box(const Case& scene, Findings& findings, const QuantitySpec& quantity,
                       const std::string& key) {
  for (int d = 0; d < 3; ++d)
    if (quantity.lower[d] < 0 || quantity.upper[d] > scene.cells[d])
      return findings.error(key, "{} reaches from {} to {} along {}; it must lie in the domain, 0 to {}", key,
                            shown(quantity.lower[d] * scene.units.cell_size),
                            shown(quantity.upper[d] * scene.units.cell_size), "xyz"[d],
                            shown(scene.cells[d] * scene.units.cell_size));
}

// What a quantity needs and the scene has not.
std::string lacking(const Case& scene, const QuantityType& type) {
  if (type.asks_for(Q::fluid) && !scene.fluid) return "the case has no [fluid]";
  if (type.asks_for(Q::bodies) && !scene.has_bodies()) return "the case has no bodies";
  if (type.asks_for(Q::gravity) && scene.gravity.norm() == 0) return "the case has no [gravity]";
  const bool driven =
      scene.any_given([](const BodySpec& b) { return b.motion == rigid::Motion::prescribed; });
  if (type.asks_for(Q::same_bodies) && (scene.bodies_come() || scene.bodies_leave()))
    return "bodies come or leave, of which it knows nothing";
  if (type.asks_for(Q::undriven) && driven)
    return "the case has a body of prescribed motion, which drives the others";
  return "";
}

bool is_wall(const BoundarySpec& side) {
  return side.kind == BoundaryKind::no_slip || side.kind == BoundaryKind::moving;
}

void check_side(const Case& scene, Findings& findings, const QuantitySpec& quantity, const std::string& key) {
  if (is_wall(scene.boundary[quantity.side])) return;
  findings.error(key, "{} is {}, which is no wall; it must be a side that is no-slip or moving", key,
                 side_key(quantity.side));
}

void check_shear(const Case& scene, Findings& findings, const QuantitySpec& quantity,
                 const std::string& key) {
  const BoundarySpec &low = scene.boundary[2 * quantity.axis], &high = scene.boundary[2 * quantity.axis + 1];
  if (is_wall(low) && is_wall(high) && low.velocity != high.velocity) return;
  findings.error(key,
                 "{} is {}, across which nothing is sheared; both sides there must be walls (no-slip or "
                 "moving), of different velocities",
                 key, "xyz"[quantity.axis]);
}

}  // namespace

void find_quantity_faults(const Case& scene, Findings& findings) {
  for (std::size_t i = 0; i < scene.quantities.size(); ++i) {
    const QuantitySpec& quantity = scene.quantities[i];
    const QuantityType& type = quantity_type(quantity.type);
    const std::string entry = fmt::format("quantities[{}]", i), lack = lacking(scene, type);
    if (!lack.empty())
      findings.error(entry + ".type", "{}.type is \"{}\", but {}", entry, quantity.type, lack);
    const bool never = type.takes(QuantityType::time)
                           ? quantity.time >= static_cast<double>(scene.steps)
                           : type.takes(QuantityType::instant) && std::isfinite(quantity.time) &&
                                 quantity.time > static_cast<double>(scene.steps);
    if (never)
      findings.warning(entry + ".time",
                       "{}.time is not before the end of the run: the quantity will have no value", entry);
    if (type.takes(QuantityType::side)) check_side(scene, findings, quantity, entry + ".side");
    if (type.asks_for(QuantityType::sheared)) check_shear(scene, findings, quantity, entry + ".axis");
    if (type.takes(QuantityType::box)) check_sampled_box(scene, findings, quantity, entry + ".box");
  }
}

}  // namespace silt::coupler
