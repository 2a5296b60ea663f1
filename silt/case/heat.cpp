// [heat], and what sides, bodies and walls are to the heat, with their checks.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "lbm/heat/heat_links.hpp"
#include "silt/case/case_check.hpp"
#include "silt/case/case_sections.hpp"

namespace silt {
namespace {

constexpr Dimension capacity_of_mass{2, -2, 0}, power{2, -3, 1}, power_of_area{0, -3, 1}, of_length{-1, 0, 0};

struct GivenHeat : coupler::HeatSpec {
  double prandtl = 0;
  rigid::Vec3 mean_gradient = rigid::Vec3::Zero();
};
constexpr double stable_peclet = 30;  // cell Péclet number from which waves grow (method-heat.md)
constexpr std::tuple heat_keys{
    Key{"thermal_diffusivity", &lbm::HeatSpec::diffusivity, Number{dimension::viscosity, range::above(0)},
        "how fast heat spreads in the fluid", "one of two"},
    Key{"prandtl", &GivenHeat::prandtl, Number{dimension::none, range::above(0)},
        "Prandtl number, the viscosity over the thermal diffusivity", "one of two"},
    Key{"temperature", &lbm::HeatSpec::reference, Number{dimension::none, range::any, "K"},
        "temperature of reference: of an inlet that gives none, where buoyancy is 0 and from which heat is "
        "counted"},
    HandKey{"initial", "number", "K", "temperature", "temperature of the fluid at the start"},
    Key{"heat_capacity", &coupler::HeatSpec::of_fluid, Number{capacity_of_mass, range::above(0), "J/(kg K)"},
        "of the fluid", "– (si), 1"},
    Key{"expansion", &coupler::HeatSpec::expansion, Number{dimension::none, range::any, "1/K"},
        "thermal expansion, which with gravity makes the fluid buoyant"},
    Key{"mean_gradient", &GivenHeat::mean_gradient, Vector{of_length, "K/m"},
        "gradient, along periodic axes, of a mean temperature on top of which all others are"}};

/// Reads the temperature of something, less that of reference.
std::optional<double> read_temperature(TableReader& table, const coupler::HeatSpec& heat) {
  const auto given = table.number("temperature", range::any);
  return given ? std::optional(*given - heat.reference) : std::nullopt;
}

void read_side(TableReader table, const coupler::BoundarySpec& side, const coupler::HeatSpec& heat,
               coupler::SideHeat& of) {
  if (const std::string given = table.one_of({"temperature", "heat_flux"}, false, "");
      !given.empty() && (side.is_periodic() || side.is_outlet()))
    table.fail(given, "{} is given, but heat passes through this side with the fluid; remove it",
               table.path(given));
  of.temperature = read_temperature(table, heat);
  of.flux = table.quantity("heat_flux", power_of_area, range::any).value_or(0) / heat.of_fluid;
}

/// Calls visit(table, side) for the sides that are tables.
template <class Visit>
void for_side_tables(TableReader& root, Visit&& visit) {
  TableReader domain = root.table("domain");
  const Node* const boundary = domain.find("boundary");
  if (!boundary || boundary->kind != Node::Kind::table) return;
  TableReader axes = domain.table("boundary");
  for (int axis = 0; axis < 3; ++axis) {
    const std::string name(axis_names.names[axis]);
    const Node* const node = axes.find(name);
    if (!node) continue;
    const bool both = node->kind == Node::Kind::table;
    for (int side = 0; side < 2; ++side) {
      if (!both && (node->kind != Node::Kind::array || int(node->children.size()) <= side)) continue;
      const Node& its = both ? *node : node->children[side];
      if (its.kind != Node::Kind::table) continue;
      const std::string path = both ? axes.path(name) : fmt::format("{}[{}]", axes.path(name), side);
      visit(TableReader(root.context(), &its, path, its.key.empty() ? its.place : its.key_place),
            2 * axis + side);
    }
  }
}

/// Reads what bodies of an entry are; those of one kind must be alike.
void read_body(TableReader& table, const Case& setup, coupler::HeatSpec& heat, std::map<int, bool>& said) {
  coupler::BodyHeat of;
  of.temperature = read_temperature(table, heat);
  const double scale =
      setup.units.scale(capacity_of_mass) * heat.of_fluid;  // the fluid's, in units of the case
  of.capacity = table.number("heat_capacity", range::above(0)).value_or(0) / scale;
  of.source = table.quantity("heat_source", power, range::any).value_or(0) / heat.of_fluid;
  if (table.has("heat_capacity")) table.need("temperature", "the temperature of the bodies at the start");
  if (of.capacity == 0)
    table.refuse_given({"heat_source"}, "{key} warms a body that has a {table}.heat_capacity; give that too");
  const std::string name = table.string("name").value_or(table.string("shape").value_or(""));
  const auto kind = std::ranges::find(setup.kind_names, name) - setup.kind_names.begin();
  if (kind == std::ptrdiff_t(setup.kind_names.size())) return;  // reported by the reader of bodies
  coupler::BodyHeat& known = heat.kinds[kind];
  if (!said.try_emplace(int(kind), true).second && !(known == of))
    table.fail("temperature",
               "{}: another entry of the name '{}' has other thermal keys; give them different names",
               table.path(), name);
  known = of;
}

/// Returns the tables of an array, none of what the reader of bodies or walls refuses.
std::vector<TableReader> tables_of(TableReader& root, const char* list) {
  const Node* const node = root.find(list);
  return node && node->kind == Node::Kind::array ? root.tables(list) : std::vector<TableReader>();
}

/// Refuses what bodies, walls and sides say of heat without [heat].
void refuse_without_heat(TableReader& root) {
  constexpr const char* why = "{key} needs the table [heat], which the case does not have";
  for (const char* list : {"bodies", "fill"})
    for (TableReader& table : tables_of(root, list))
      table.refuse_given({"temperature", "heat_capacity", "heat_source"}, why);
  for (TableReader& table : tables_of(root, "walls")) table.refuse_given({"temperature"}, why);
  for_side_tables(root, [&](TableReader table, int) {
    table.refuse_given({"temperature", "heat_flux"}, why);
  });
}

/// Refuses fields of the temperature without [heat].
void check_fields(const Case& setup, Diagnostics& findings) {
  const auto look = [&](const char* key, const std::vector<Field>& fields) {
    if (std::ranges::count(fields, Field::temperature))
      findings.error(key, "{} has \"temperature\", but the case has no [heat]; take it out", key);
  };
  look("output.fields.quantities", setup.output.fields.quantities);
  for (const FieldsSpec& slice : setup.output.slices) look("output.slices", slice.quantities);
  for (const ProbesSpec& probes : setup.output.probes) look("output.probes", probes.quantities);
}

/// Refuses a mean gradient along axes that are not periodic, and bodies that would carry their temperature
/// along it.
void check_mean_gradient(const Case& setup, Diagnostics& findings) {
  constexpr const char* key = "heat.mean_gradient";
  for (int d = 0; d < 3; ++d)
    if (setup.heat->gradient[d] != 0 && !setup.periodic(d))
      findings.error(
          key, "{} has a component along {}, which is not periodic; give its sides temperatures instead", key,
          "xyz"[d]);
  const auto is_warm = [&](const auto& of) { return setup.heat->kinds[of.kind].temperature.has_value(); };
  const auto moves = [&](const BodySpec& body) {
    return body.motion != rigid::Motion::fixed && is_warm(body);
  };
  if (setup.heat->has_gradient() && (setup.any_given(moves) || std::ranges::any_of(setup.fills, is_warm)))
    findings.error(key, "{} is given, and bodies of a temperature move; they must be fixed, or insulating",
                   key);
}

/// Refuses gravity that changes, of which buoyancy knows nothing.
void check_constant_gravity(const Case& setup, Diagnostics& findings) {
  if (setup.heat->expansion == 0 || !setup.gravity_over_time.varies()) return;
  findings.error("gravity.over_time",
                 "[heat] cannot be combined with gravity that changes, if the fluid expands; remove one of "
                 "them");
}

/// Warns of a heat capacity that no fluid has, as one in kJ/(kg K).
void check_capacity(const Case& setup, Diagnostics& findings) {
  constexpr double least = 100, most = 15000;  // J/(kg K): below mercury, above hydrogen
  constexpr double kilojoules = 1000;
  const double found = setup.units.physical(setup.heat->of_fluid, capacity_of_mass);
  if (!setup.units.si || (found >= least && found <= most)) return;
  const double meant = kilojoules * found;
  findings.warning("heat.heat_capacity",
                   "heat.heat_capacity is {} J/(kg K); fluids have 139 (mercury) to 14300 (hydrogen), water "
                   "has 4180{}",
                   shown(found),
                   meant >= least && meant <= most
                       ? fmt::format(": if it is in kJ/(kg K), write {} (J/(kg K))", shown(meant))
                       : "");
}

/// Warns of temperatures on two scales, and of others too far apart for a fluid that is light in its weight
/// alone (method-heat.md). In lattice units only the product of expansion and gravity means something.
void check_expansion(const Case& setup, Diagnostics& findings) {
  constexpr double most = 0.5;
  const double difference = given_temperatures(*setup.heat).difference();
  const double change = std::abs(setup.heat->expansion) * difference;
  if (!setup.units.si || setup.gravity.isZero(0) || change <= most * (1 + unseen)) return;
  findings.warning(
      "heat.expansion",
      "temperatures differ by {} K, and times heat.expansion that is {} of the fluid's density; above "
      "{} no fluid keeps its density, as the method assumes: are all temperatures on one scale, "
      "and the expansion in 1/K?",
      shown(difference), shown(change), most);
}

/// Warns of a thermal diffusivity in mm2/s; returns whether it did.
bool diffusivity_is_in_millimetres(const Case& setup, Diagnostics& findings) {
  constexpr const char* key = "heat.thermal_diffusivity";
  constexpr double least = 1e-8, most = 1e-2, square_millimetres = 1e6;  // m2/s: oils to thin hydrogen
  const double found = setup.units.physical(setup.heat->diffusivity, dimension::viscosity);
  const double meant = found / square_millimetres;
  if (!setup.units.si || !setup.places.count(key) || found <= most || meant < least) return false;
  findings.warning(key,
                   "{} is {} m2/s; water has 1.4e-07, which is 0.14 mm2/s, and air 2.1e-05: if it is in "
                   "mm2/s, write {} (m2/s)",
                   key, shown(found), shown(meant));
  return true;
}

}  // namespace

double cell_peclet(const Case& setup) {
  return fastest_given(setup) / setup.heat->diffusivity;
}

TemperatureLimits given_temperatures(const coupler::HeatSpec& heat) {
  double least = std::min(heat.initial, 0.), most = std::max(heat.initial, 0.);
  const auto see = [&](const auto& all) {
    for (const auto& of : all)
      least = std::min(least, of.temperature.value_or(0)), most = std::max(most, of.temperature.value_or(0));
  };
  see(heat.sides), see(heat.kinds), see(heat.walls);
  return {least, most};
}

TemperatureLimits possible_temperatures(const Case& setup) {
  constexpr double range_of_sums = 0x1p62 * lbm::heat_quantum;
  const coupler::HeatSpec& heat = *setup.heat;
  const TemperatureLimits given = given_temperatures(heat);
  const bool bounded = given.difference() > 0 && !setup.start && !heat.has_gradient() &&
                       std::ranges::all_of(heat.sides, [](const auto& side) { return side.flux == 0; }) &&
                       std::ranges::all_of(heat.kinds, [](const auto& kind) { return kind.source == 0; });
  if (!bounded) return {-range_of_sums, range_of_sums};
  return {given.least - given.difference(), given.most + given.difference()};
}

std::vector<KeySection> heat_sections() {
  return {section_of("heat", heat_keys)};
}

void read_heat(TableReader& root, Case& setup) {
  TableReader table = root.table("heat");
  if (!table.present()) return refuse_without_heat(root);
  if (!setup.fluid)
    return root.fail("heat", "[heat] is given, but there is no [fluid] that could be warm; remove it");
  GivenHeat heat;
  read_keys(table, heat, heat_keys);
  if (table.one_of({"thermal_diffusivity", "prandtl"}, true, "how fast heat spreads") == "prandtl" &&
      heat.prandtl > 0)
    heat.diffusivity = setup.fluid->kinematic_viscosity / heat.prandtl;
  if (setup.units.si) table.need("heat_capacity", "of the fluid, J/(kg K)");
  heat.initial = table.number("initial", range::any).value_or(heat.reference) - heat.reference;
  for (int d = 0; d < 3; ++d)
    heat.buoyancy[d] = -heat.expansion * setup.gravity[d], heat.gradient[d] = heat.mean_gradient[d];
  if (heat.expansion != 0 && setup.gravity.isZero(0))
    table.idle("expansion", "there is no [gravity]; remove it");
  for_side_tables(
      root, [&](TableReader of, int side) { read_side(of, setup.boundary[side], heat, heat.sides[side]); });
  heat.kinds.resize(setup.kind_names.size());
  std::map<int, bool> said;
  for (const char* list : {"bodies", "fill"})
    for (TableReader& entry : tables_of(root, list)) read_body(entry, setup, heat, said);
  for (TableReader& wall : tables_of(root, "walls"))
    heat.walls.emplace_back().temperature = read_temperature(wall, heat);
  setup.heat = heat;
}

std::string doubt_of_heat(const Case& setup, double speed) {
  const double found = setup.heat ? speed / setup.heat->diffusivity : 0;
  if (found <= stable_peclet) return "";
  return fmt::format("a cell Péclet number u/D of {}; above {} waves of temperature grow: use smaller cells",
                     shown(found), stable_peclet);
}

void find_heat_faults(const Case& setup, Diagnostics& findings) {
  if (!setup.heat) return check_fields(setup, findings);
  check_constant_gravity(setup, findings);
  check_mean_gradient(setup, findings);
  constexpr double measured = 10;  // cell Péclet number (method-heat.md)
  const double found = cell_peclet(setup);
  const double in_widest = found * (setup.coarsening ? 1 << setup.coarsening->levels : 1);
  const char* const key = setup.places.count("heat.prandtl") ? "heat.prandtl" : "heat.thermal_diffusivity";
  if (in_widest > stable_peclet)
    findings.error(
        key,
        "the cell Péclet number u/D is {} in the widest cells at the largest speed given; above {} waves "
        "grow: use smaller cells",
        shown(in_widest), stable_peclet);
  else if (found > measured)
    findings.warning(
        key,
        "the cell Péclet number u/D is {} at the largest speed given; above {} heat is carried with "
        "large errors: use smaller cells",
        shown(found), measured);
  if (setup.heat->expansion == 0 && !setup.gravity.isZero(0) && !setup.has_free_bodies())
    findings.idle("gravity", "it acts on free bodies, and on fluid that expands; give heat.expansion");
  check_capacity(setup, findings);
  check_expansion(setup, findings);
  if (diffusivity_is_in_millimetres(setup, findings)) return;
  constexpr double accurate = 0.2;
  if (const double diffusivity = setup.heat->diffusivity; diffusivity > accurate)
    findings.warning(
        key,
        "the thermal diffusivity is {} cells2/step; above {} heat that comes and goes is late by "
        "percents: {}",
        shown(diffusivity), accurate,
        setup.units.si ? time_step_cure(setup, accurate / diffusivity) : "use shorter steps");
}

}  // namespace silt
