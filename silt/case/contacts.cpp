// [contacts] and [[material_pairs]], with their checks.

#include <algorithm>
#include <numbers>

#include "adapters/automatic/collision_factory.hpp"
#include "rigid/math/elementary.hpp"
#include "rigid/shapes/shape.hpp"
#include "silt/case/case_sections.hpp"

namespace silt {
namespace {

constexpr auto unit_interval = range::between(0, 1);

constexpr std::tuple contact_keys{
    HandKey{"backend", "\"auto\", \"analytic\", \"bullet\", \"fcl\"", "", "\"auto\"",
            "engine that finds the contacts of a pair of shapes; \"auto\": the best one for each pair"},
    HandKey{"resolver", "\"sffd\", \"ffd\"", "", "\"sffd\"", "contact resolver"},
    Key{"substeps", &ContactSpec::substeps, Whole{1, 100000},
        "sub-steps of the bodies in a step of the fluid"},
    Key{"margin", &ContactSpec::margin, Number{dimension::length, range::at_least(0)},
        "gap at which a pair becomes a contact; without a fluid bodies may move by half of it plus half "
        "their least width in a sub-step",
        "1 cell"}};

constexpr std::tuple material_keys{
    Key{"restitution", &rigid::Material::restitution, Number{dimension::none, unit_interval},
        "coefficient of restitution in air; in a fluid sffd also reverses the entrained fluid, but not with "
        "impact_sweeps"},
    Key{"friction", &rigid::Material::friction, Number{dimension::none, range::at_least(0)},
        "Coulomb's coefficient of friction"},
    Key{"rolling_friction", &rigid::Material::rolling_friction, Number{dimension::none, range::at_least(0)},
        "sffd: the moment against rolling is at most this times the normal force and the reduced radius"},
    Key{"twisting_friction", &rigid::Material::twisting_friction, Number{dimension::none, range::at_least(0)},
        "sffd: the same against rotation about the normal"},
    Key{"cohesion", &rigid::Material::cohesion, Number{dimension::force, range::at_least(0)},
        "sffd: the force needed to separate two bodies in contact"},
    Key{"hamaker", &rigid::Material::hamaker, Number{dimension::energy, range::at_least(0)},
        "sffd: Hamaker's constant A of van der Waals' attraction, A R / (6 gap²) with the reduced radius R"},
    Key{"hamaker_gap", &rigid::Material::hamaker_gap, Number{dimension::length, range::above(0)},
        "of hamaker: the gap below which the attraction is constant; beyond ten times this gap there is none",
        "with hamaker",
        Rule{If::needed, [](const rigid::Material& m) { return m.hamaker > 0 && m.hamaker_gap == 0; }}}};

constexpr std::tuple resolver_keys{
    Key{"sweeps", &rigid::ResolverSettings::max_sweeps, Whole{1, 100000},
        "largest number of sweeps over the contacts in a sub-step; increase it for heavy bodies that fall on "
        "stacks: a run warns if the sweeps end far from convergence"},
    Key{"impact_sweeps", &rigid::ResolverSettings::impact_sweeps, Whole{0, 100000},
        "sffd: rounds of collisions through touching bodies before contacts, and sweeps of each, at most, as "
        "in Newton's cradle (0: none)",
        "0; dry pairs of restitution 1: 1000"}};

constexpr std::tuple between_keys{
    HandKey{"between", "[\"a\", \"b\"]", "", required,
            "names of two materials of bodies and walls; \"default\" is the material of all others"}};

/// Reads the name of an engine; reports one that this build lacks.
std::optional<std::string> read_engine(TableReader& table, const char* key,
                                       const std::vector<std::string_view>& names) {
  const Node* node = table.find(key);
  const std::string left_out =
      node && node->kind == Node::Kind::string ? adapters::missing_from_build(node->string) : "";
  if (left_out.empty()) return table.choice(key, {names.begin(), names.end()});
  table.fail(key, "{} is \"{}\"; {}", table.path(key), node->string, left_out);
  return {};
}

/// Reads the material of one pair or of all.
void read_material(TableReader& table, rigid::Material& material, const ContactSpec& contacts) {
  read_keys(table, material, material_keys);
  for (const auto& [key, value] : {std::pair{"rolling_friction", material.rolling_friction},
                                   {"twisting_friction", material.twisting_friction},
                                   {"cohesion", material.cohesion},
                                   {"hamaker", material.hamaker}}) {
    if (value > 0 && table.has(key) && !rigid::resolver_model(contacts.resolver).resists_rolling_and_pulls)
      table.fail(key,
                 "{} is given, but contacts.resolver is '{}', which knows restitution and friction only; set "
                 "contacts.resolver = \"sffd\", or remove the key",
                 table.path(key), contacts.resolver);
  }
}

/// Returns the names of two materials; empty (reported) for anything else.
std::vector<std::string> read_between(TableReader& pair) {
  rigid::Material unused;
  read_keys(pair, unused, between_keys);
  const Node* between = pair.find("between");
  const auto names = between ? between->strings() : std::nullopt;
  if (names && names->size() == 2) return *names;
  if (between) pair.refuse("between", "the names of two materials, [\"a\", \"b\"]");
  return {};
}

std::size_t index_of_material(const Case& setup, const std::string& name) {
  return std::size_t(std::ranges::find(setup.material_names, name) - setup.material_names.begin());
}

/// Collects the materials that pairs name, in order after "default".
void read_materials(TableReader& root, const rigid::Material& standard, Case& setup) {
  setup.material_names = {"default"};
  std::vector<TableReader> pairs = root.tables("material_pairs");
  std::vector<std::vector<std::string>> names;
  for (TableReader& pair : pairs)
    for (const std::string& name : names.emplace_back(read_between(pair)))
      if (index_of_material(setup, name) == setup.material_names.size()) setup.material_names.push_back(name);
  const std::size_t count = setup.material_names.size();
  setup.pair_materials.assign(count * count, standard);
  for (std::size_t k = 0; k < pairs.size(); ++k) {
    rigid::Material unused;
    if (names[k].empty()) {
      read_material(pairs[k], unused, setup.contacts);
      continue;
    }
    const std::size_t a = index_of_material(setup, names[k][0]), b = index_of_material(setup, names[k][1]);
    rigid::Material& material = setup.pair_materials[a * count + b];
    read_material(pairs[k], material, setup.contacts);
    if (material.hamaker == 0)
      pairs[k].idle("hamaker_gap", "there is no hamaker; give it, or remove the gap");
    setup.pair_materials[b * count + a] = material;
  }
}

/// Resolves collisions without dissipation one after the other if there is no fluid: solved together, one of
/// three bodies that meet in a step may merely be stopped.
void collide_without_loss(Case& setup) {
  constexpr int enough = 1000;  // a cluster comes to rest earlier
  const bool some =
      std::ranges::any_of(setup.pair_materials, [](const rigid::Material& m) { return m.restitution == 1; });
  if (!some || setup.fluid || !rigid::resolver_model(setup.contacts.resolver).has_impact_phase) return;
  setup.contacts.resolver_settings.impact_sweeps = enough;
  setup.contacts.resolver_settings.least_impact_restitution = 1;
}

/// Rejects keys that the resolver does not have.
void require_resolver(TableReader& table, const ContactSpec& contacts) {
  const rigid::ResolverModel& resolver = rigid::resolver_model(contacts.resolver);
  const int impact_sweeps = contacts.resolver_settings.impact_sweeps;
  if (impact_sweeps > 0 && !resolver.has_impact_phase)
    table.fail("impact_sweeps",
               "{} is {}, but contacts.resolver is '{}', which has no impact phase; set contacts.resolver = "
               "\"sffd\", or remove the key",
               table.path("impact_sweeps"), impact_sweeps, contacts.resolver);
  if (!resolver.sweeps)
    table.idle("sweeps", fmt::format("contacts.resolver is '{}', which makes none; set contacts.resolver = "
                                     "\"sffd\", or remove the key",
                                     contacts.resolver));
}

constexpr double most_friction = 5;    // of dry matter: up to about 1
constexpr double steepest_angle = 89;  // degrees
constexpr double usual_margin = 1;     // cells

/// Returns the key of a coefficient, that of all pairs or that of the only one.
std::string coefficient_key(const Case& setup, const std::string& name) {
  std::vector<std::string> keys;
  for (const auto& [key, place] : setup.places)
    if ((key.starts_with("contacts") || key.starts_with("material_pairs")) && key.ends_with("." + name))
      keys.push_back(key);
  return keys.size() == 1 ? keys[0] : "material_pairs";
}

void check_materials(const Case& setup, Diagnostics& findings) {
  double highest = 0;
  for (const rigid::Material& material : setup.pair_materials) {
    highest = std::max(highest, material.friction);
    for (const auto& [name, value, range] : {std::tuple("restitution", material.restitution, unit_interval),
                                             std::tuple("friction", material.friction, range::at_least(0))})
      if (!range.holds(value))
        findings.error(fmt::format("contacts.{}", name), "a {} is {}; it must be {}", name, shown(value),
                       range.text());
  }
  if (highest <= most_friction) return;
  const double degrees = std::min(highest, steepest_angle), angle = degrees * std::numbers::pi / 180;
  findings.warning(coefficient_key(setup, "friction"),
                   "a friction is {}; of dry matter it is up to about 1: it is no angle but the tangent of "
                   "one, {:.2f} for {} degrees",
                   shown(highest), rigid::elementary::sin(angle) / rigid::elementary::cos(angle),
                   shown(degrees));
}

void check_margin(const Case& setup, Diagnostics& findings) {
  const double margin = setup.contacts.margin;
  if (!(margin >= 0))
    findings.error("contacts.margin", "contacts.margin is {} cells; it must be at least 0", shown(margin));
  const double shortest = *std::ranges::min_element(setup.cells);
  double largest = 0;
  for (const Entry& entry : entries_of(setup))
    largest = std::max(largest, 2 * rigid::bounding_radius(setup.shapes[entry.shape]));
  if (!setup.has_bodies() || margin <= std::max(usual_margin, largest)) return;
  findings.warning("contacts.margin",
                   "contacts.margin is {}, more than the largest body ({}) and {} of the domain's shortest "
                   "side: every pair nearer than that is a contact; use {} (one cell)",
                   shown_length(setup, margin), shown_length(setup, largest), shown(margin / shortest),
                   shown_length(setup, usual_margin));
}

void check_lubrication(const Case& setup, Diagnostics& findings) {
  if (setup.coupling.lubrication && !setup.has_lubrication()) {
    const std::string why = fmt::format(
        "contacts.resolver is '{}', which has no lubrication films; set contacts.resolver = \"sffd\", or "
        "remove the key",
        setup.contacts.resolver);
    if (setup.places.count("coupling.lubrication"))
      findings.error("coupling.lubrication", "coupling.lubrication is true, but {}", why);
    findings.idle("coupling.lubrication_min_gap", why);
  }
  const double gap = setup.coupling.lubrication_min_gap;
  if (gap > usual_margin)
    findings.warning("coupling.lubrication_min_gap",
                     "coupling.lubrication_min_gap is {}, which the lattice resolves ({} cells): it is the "
                     "height of a surface's roughness; without the key it is a thousandth of the radius",
                     shown_length(setup, gap), shown(gap));
}

}  // namespace

std::vector<KeySection> contact_sections() {
  KeySection pairs = section_of("material_pairs", between_keys, material_keys);
  for (KeyText& key : pairs.keys)
    if (key.fallback == "0") key.fallback = "of [contacts]";
  return {section_of("contacts", contact_keys, material_keys, resolver_keys), pairs};
}

void read_contacts(TableReader& root, Case& setup) {
  rigid::Material standard;
  TableReader table = root.table("contacts");
  ContactSpec& c = setup.contacts;
  read_keys(table, c, contact_keys);
  read_keys(table, c.resolver_settings, resolver_keys);
  c.backend = read_engine(table, "backend", adapters::backend_names()).value_or(c.backend);
  std::vector<std::string> resolvers;
  for (const rigid::ResolverModel& model : rigid::resolver_models()) resolvers.emplace_back(model.name);
  c.resolver = table.choice("resolver", resolvers).value_or(c.resolver);
  require_resolver(table, c);
  read_material(table, standard, c);
  read_materials(root, standard, setup);
  if (!table.has("impact_sweeps")) collide_without_loss(setup);
  if (std::ranges::all_of(setup.pair_materials, [](const rigid::Material& m) { return m.hamaker == 0; }))
    table.idle("hamaker_gap", "there is no hamaker; give it, or remove the gap");
}

void look_for_idle_pairs(TableReader& root, const Case& setup) {
  if (!root.context().errors.empty() || !setup.has_free_bodies()) return;
  std::vector<std::uint64_t> free(setup.material_names.size()), all = free;
  const auto add = [&](const BodySpec& body, std::uint64_t count) {
    all[std::size_t(body.material)] += count;
    if (body.motion == rigid::Motion::free) free[std::size_t(body.material)] += count;
  };
  constexpr std::uint64_t several = 2;  // for bodies that arrive, fill sites or were in another run
  setup.for_each_given(add);
  for (const BodySpec& body : setup.continued) add(body, several);
  for (const FillSpec& fill : setup.fills) {
    all[std::size_t(fill.material)] += several;
    free[std::size_t(fill.material)] += several;
  }
  for (const CurvedWall& wall : setup.walls)
    all[std::size_t(std::visit([](const auto& of_kind) { return of_kind.material; }, wall.surface))] += 1;
  all[0] += 1;  // the sides of the domain
  std::vector<std::string> used;
  for (std::size_t i = 0; i < all.size(); ++i)
    if (all[i] > 0) used.push_back(setup.material_names[i]);
  const auto meet = [&](std::size_t a, std::size_t b) { return free[a] > 0 && all[b] > (a == b ? 1u : 0u); };
  for (TableReader& pair : root.tables("material_pairs")) {
    const auto names = pair.find("between")->strings().value();
    const auto unused =
        std::ranges::find_if(names, [&](const std::string& n) { return !std::ranges::count(used, n); });
    const std::size_t a = index_of_material(setup, names[0]), b = index_of_material(setup, names[1]);
    if (unused != names.end())
      pair.warn("between", "{} has no effect: no body and no wall is of the material '{}'{}", pair.path(),
                *unused, suggestion(*unused, used));
    else if (!meet(a, b) && !meet(b, a))
      pair.warn("between",
                "{} has no effect: no body meets another, or a wall, of these materials; remove it",
                pair.path());
  }
}

void find_contact_faults(const Case& setup, Diagnostics& findings) {
  check_materials(setup, findings);
  check_margin(setup, findings);
  check_lubrication(setup, findings);
  for (const auto& [path, place] : setup.places)
    if (!setup.has_free_bodies() && path.ends_with(".material")) findings.idle(path, no_free_bodies);
}

}  // namespace silt
