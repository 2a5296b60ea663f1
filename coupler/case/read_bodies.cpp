// [contacts], [[materials]], [[material_pairs]], [[bodies]], [[fill]], [[outflow]]
#include <fmt/format.h>

#include <algorithm>

#include "adapters/automatic/broad_phase_factory.hpp"
#include "adapters/automatic/collision_factory.hpp"
#include "coupler/case/case.hpp"
#include "coupler/case/case_extent.hpp"
#include "coupler/case/case_sections.hpp"
#include "coupler/case/case_source.hpp"
#include "rigid/shapes/shape.hpp"

namespace silt::coupler {
namespace {

using rigid::Vec3;

constexpr auto unit_interval = range::between(0, 1);

std::vector<std::string> as_strings(const std::vector<std::string_view>& names) {
  return {names.begin(), names.end()};
}

/// One of those that this build has; of one that it was configured without that is said.
std::optional<std::string> read_engine(TableReader& table, const char* key,
                                       const std::vector<std::string_view>& names) {
  const Node* node = table.find(key);
  const std::string left_out =
      node && node->kind == Node::Kind::string ? adapters::left_out_of_this_build(node->string) : "";
  if (left_out.empty()) return table.choice(key, as_strings(names));
  table.fail(key, fmt::format("{} is \"{}\"; {}", table.path(key), node->string, left_out));
  return {};
}

std::vector<std::string> resolver_names() {
  std::vector<std::string> names;
  for (const rigid::ResolverModel& model : rigid::resolver_models()) names.emplace_back(model.name);
  return names;
}

void read_material_pairs(TableReader& root, Case& scene) {
  const int count = static_cast<int>(scene.material_names.size());
  for (TableReader& pair : root.tables("material_pairs")) {
    const Node* between = pair.find("between");
    if (!between) {
      pair.missing("between", "the names of two materials");
      continue;
    }
    int index[2] = {-1, -1};
    const bool two_names = between->kind == Node::Kind::array && between->children.size() == 2 &&
                           between->children[0].kind == Node::Kind::string &&
                           between->children[1].kind == Node::Kind::string;
    if (two_names)
      for (int k = 0; k < 2; ++k)
        index[k] = index_of(pair, "between", between->children[k].string, scene.material_names, "material");
    else
      pair.refuse("between", "the names of two materials, [\"a\", \"b\"]");
    const auto restitution = pair.number("restitution", unit_interval);
    const auto friction = pair.number("friction", range::at_least(0));
    if (index[0] < 0 || index[1] < 0) continue;
    for (const int at : {index[0] * count + index[1], index[1] * count + index[0]}) {
      rigid::Material& material = scene.pair_materials[at];
      material.restitution = restitution.value_or(material.restitution);
      material.friction = friction.value_or(material.friction);
    }
  }
}

void read_materials(TableReader& root, const rigid::Material& standard, Case& scene) {
  scene.material_names = {"default"};
  for (TableReader& entry : root.tables("materials")) {
    if (!entry.has("name")) entry.missing("name", "what bodies and pairs call the material");
    const auto name = entry.string("name");
    if (!name) continue;
    if (std::count(scene.material_names.begin(), scene.material_names.end(), *name))
      entry.fail("name", fmt::format("{}: there already is a material '{}'", entry.path("name"), *name));
    scene.material_names.push_back(*name);
  }
  scene.pair_materials.assign(scene.material_names.size() * scene.material_names.size(), standard);
  read_material_pairs(root, scene);
}

/// Pairs that lose nothing collide one after the other, where no fluid takes part: all at once, one of three
/// bodies that meet in a step may be only stopped.
void collide_without_loss(Case& scene) {
  constexpr int enough = 1000;  // a cluster comes to rest before
  const bool some = std::any_of(scene.pair_materials.begin(), scene.pair_materials.end(),
                                [](const rigid::Material& m) { return m.restitution == 1; });
  if (!some || scene.fluid || !rigid::resolver_model(scene.contacts.resolver).has_impact_phase) return;
  scene.contacts.resolver_settings.impact_sweeps = enough;
  scene.contacts.resolver_settings.least_impact_restitution = 1;
}

int read_shape_name(TableReader& table, const Case& scene) {
  if (!table.has("shape"))
    table.missing("shape", "the name of one of [[shapes]]: " + joined(scene.shape_names));
  const auto name = table.string("shape");
  return name ? std::max(0, index_of(table, "shape", *name, scene.shape_names, "shape")) : 0;
}

// Entries of one name make one kind, of one shape; without a name it is the shape's.
int read_kind(TableReader& table, int shape, Case& scene) {
  const std::string fallback =
      shape < static_cast<int>(scene.shape_names.size()) ? scene.shape_names[shape] : std::string("body");
  const std::string name = table.string("name").value_or(fallback);
  const auto found = std::find(scene.kind_names.begin(), scene.kind_names.end(), name);
  const int kind = static_cast<int>(found - scene.kind_names.begin());
  if (found == scene.kind_names.end()) {
    if (constexpr std::size_t most = 4000;
        scene.kind_names.size() == most)  // as many as a table of bodies.h5 has
      table.fail("name",
                 fmt::format("there are more than {} names of bodies; give several the same one", most));
    scene.kind_names.push_back(name);
    scene.kind_shapes.push_back(shape);
  } else if (scene.kind_shapes[kind] != shape) {
    table.fail("name",
               fmt::format(
                   "{}: another entry of the name '{}' has the shape '{}', this one '{}'; entries of one "
                   "name have one shape: give them different names",
                   table.path(), name, scene.shape_names[scene.kind_shapes[kind]], scene.shape_names[shape]));
  }
  return kind;
}

double read_density(TableReader& table) {
  if (!table.has("density")) table.missing("density", "of the body, in the units of the case");
  return table.quantity("density", dimension::density, range::above(0)).value_or(1);
}

/// What a file of positions says as well must not be given by a key, nor be what a fixed body cannot have.
void check_contents(TableReader& table, const BodySpec& body, const std::string& name,
                    const PositionContents& in) {
  const auto refuse_twice = [&](bool in_file, std::initializer_list<const char*> keys) {
    for (const char* key : keys)
      if (in_file && table.has(key))
        table.fail(key, fmt::format("{} is given, and '{}' has columns of it: remove one of the two",
                                    table.path(key), name));
  };
  refuse_twice(in.orientation, {"orientation", "axis_angle", "axis"});
  refuse_twice(in.velocity, {"velocity"});
  refuse_twice(in.angular_velocity, {"angular_velocity"});
  const std::array<double, 3> none = {};
  if (body.motion == rigid::Motion::fixed && (in.fastest != none || in.fastest_turn != none))
    table.fail("positions",
               fmt::format("{}: '{}' has velocities, but the bodies are fixed; set motion = \"free\" or "
                           "\"prescribed\", or remove these columns",
                           table.path("positions"), name));
}

/// Positions in a file: only how many there are is looked at, and how fast the fastest are.
void read_filed_bodies(TableReader& table, BodySpec alike, Case& scene) {
  ReadContext& context = table.context();
  const auto name = table.string("positions");
  if (!name) return;
  try {
    const AttachedFile& file = context.source->positions_named(*name);
    context.files.push_back(file.fingerprint);
    const PositionContents& in = file.positions;
    check_contents(table, alike, *name, in);
    if (in.velocity) alike.velocity = Vec3(in.fastest.data()) / context.units.scale(dimension::velocity);
    if (in.angular_velocity)
      alike.angular_velocity =
          Vec3(in.fastest_turn.data()) / context.units.scale(dimension::angular_velocity);
    scene.filed.push_back({alike, position_file(*name), in});
  } catch (const std::invalid_argument& error) {
    table.fail("positions", fmt::format("{}: '{}': {}", table.path("positions"), *name, error.what()));
  }
}

std::vector<Vec3> read_positions(TableReader& table, const Units& units) {
  std::vector<Vec3> positions;
  const std::string given = table.one_of({"position", "positions"}, true, "where the body is");
  if (given == "position") {
    if (const auto x = table.vector(given, dimension::length)) positions.push_back(*x);
  } else if (given == "positions") {
    const Node* node = table.find(given);
    if (node->kind != Node::Kind::array || node->children.empty()) {
      table.refuse(given, "a list of positions, [[x, y, z], ...], or the name of a file of them");
      return positions;
    }
    for (std::size_t i = 0; i < node->children.size(); ++i)
      if (const auto x =
              read_vector(table.context(), node->children[i], fmt::format("{}[{}]", table.path(given), i)))
        positions.push_back(*x / units.cell_size);
  }
  return positions;
}

/// The point of a shape, from its centre of mass, that positions of bodies name.
Vec3 read_origin(TableReader& table, int shape, const Case& scene) {
  const bool centre = table.choice("origin", {"shape", "centre"}) == "centre";
  return centre || scene.shapes.empty() ? Vec3(Vec3::Zero()) : scene.shape_origins[shape];
}

}  // namespace

int read_material_name(TableReader& table, const std::vector<std::string>& material_names) {
  const auto name = table.string("material");
  return name ? std::max(0, index_of(table, "material", *name, material_names, "material")) : 0;
}

void read_sleep(TableReader& table, const rigid::ResolverModel& resolver, ContactSpec& contacts) {
  contacts.sleep_speed = table.quantity("sleep_speed", dimension::velocity, range::above(0));
  contacts.sleep_time = table.quantity("sleep_time", dimension::time, range::above(0));
  if (contacts.sleep_speed && !resolver.lets_sleep)
    table.fail("sleep_speed",
               fmt::format("{} is given, but contacts.resolver is '{}', where no body sleeps; set "
                           "contacts.resolver = \"sffd\", or remove the key",
                           table.path("sleep_speed"), contacts.resolver));
  if (contacts.sleep_time && !contacts.sleep_speed)
    table.missing("sleep_speed", "the speed below which bodies are at rest: sleep_time says how long");
}

void read_contacts(TableReader& root, Case& scene) {
  rigid::Material standard;
  TableReader table = root.table("contacts");
  const bool impacts_given = table.present() && table.has("impact_sweeps");
  if (table.present()) {
    ContactSpec& c = scene.contacts;
    c.backend = read_engine(table, "backend", adapters::backend_names()).value_or(c.backend);
    c.broad_phase = read_engine(table, "broad_phase", adapters::broad_phase_names()).value_or(c.broad_phase);
    c.resolver = table.choice("resolver", resolver_names()).value_or(c.resolver);
    const rigid::ResolverModel& resolver = rigid::resolver_model(c.resolver);
    standard.restitution = table.number("restitution", unit_interval).value_or(0);
    standard.friction = table.number("friction", range::at_least(0)).value_or(0);
    auto& settings = c.resolver_settings;
    settings.max_sweeps = static_cast<int>(table.integer("sweeps", 1, 100000).value_or(settings.max_sweeps));
    settings.impact_sweeps =
        static_cast<int>(table.integer("impact_sweeps", 0, 100000).value_or(settings.impact_sweeps));
    if (settings.impact_sweeps > 0 && !resolver.has_impact_phase)
      table.fail("impact_sweeps",
                 fmt::format("{} is {}, but contacts.resolver is '{}', which has no impact phase; "
                             "set contacts.resolver = \"sffd\", or remove the key",
                             table.path("impact_sweeps"), settings.impact_sweeps, c.resolver));
    settings.half_force = table.boolean("half_force").value_or(settings.half_force);
    if (table.has("half_force") && !resolver.has_half_force)
      table.fail(
          "half_force",
          fmt::format("{} is for the classic resolver, but contacts.resolver is '{}', where all of a "
                      "force acts before the contacts; set contacts.resolver = \"ffd\", or remove the key",
                      table.path("half_force"), c.resolver));
    settings.correction = table.number("correction", unit_interval).value_or(settings.correction);
    c.substeps = static_cast<int>(table.integer("substeps", 1, 100000).value_or(c.substeps));
    c.margin = table.quantity("margin", dimension::length, range::at_least(0)).value_or(c.margin);
    read_sleep(table, resolver, c);
  }
  read_materials(root, standard, scene);
  if (!impacts_given) collide_without_loss(scene);
}

void read_bodies(TableReader& root, Case& scene) {
  int entry = 0;
  for (TableReader& table : root.tables("bodies")) {
    BodySpec body;
    body.entry = entry++;
    body.shape = read_shape_name(table, scene);
    body.material = read_material_name(table, scene.material_names);
    body.kind = read_kind(table, body.shape, scene);
    body.density = read_density(table);
    body.motion = table.choice("motion", motion_names).value_or(body.motion);
    body.pose.orientation = read_orientation(table);
    body.origin = read_origin(table, body.shape, scene);
    if (body.motion == rigid::Motion::fixed) {
      for (const char* key : {"velocity", "angular_velocity"})
        if (table.has(key))
          table.fail(key, fmt::format("{} is given for a fixed body; remove it, or set motion = "
                                      "\"prescribed\"",
                                      table.path(key)));
    } else {
      body.velocity = table.vector("velocity", dimension::velocity).value_or(body.velocity);
      body.angular_velocity =
          table.vector("angular_velocity", dimension::angular_velocity).value_or(body.angular_velocity);
    }
    const Node* positions = table.find("positions");
    if (positions && positions->kind == Node::Kind::string && !table.has("position")) {
      read_filed_bodies(table, body, scene);
      continue;
    }
    for (const Vec3& position : read_positions(table, scene.units)) {
      put_at(body, position, extent_of(scene));
      scene.bodies.push_back(body);
    }
  }
}

void read_box(TableReader& table, const std::array<int, 3>& cells, Vec3& lower, Vec3& upper) {
  lower = Vec3::Zero();
  upper = Vec3(cells[0], cells[1], cells[2]);
  const Node* box = table.find("box");
  if (!box) return;
  if (box->kind != Node::Kind::array || box->children.size() != 2) {
    table.refuse("box", "two corners, [[x, y, z], [x, y, z]]");
    return;
  }
  const auto low = read_vector(table.context(), box->children[0], table.path("box") + "[0]");
  const auto high = read_vector(table.context(), box->children[1], table.path("box") + "[1]");
  if (!low || !high) return;
  const double cell_size = table.context().units.cell_size;
  lower = *low / cell_size;
  upper = *high / cell_size;
  if ((upper - lower).minCoeff() <= 0)
    table.refuse("box", "two corners, [lower, upper], the upper above the lower in each direction");
}

namespace {

/// How many bodies, and where those are that do not lie at random.
void read_sites(TableReader& table, FillSpec& fill) {
  const bool random = fill.arrangement == Arrangement::random;
  if (random && !table.has("count")) table.missing("count", "how many bodies to place");
  fill.count = table.integer("count", 1, 100'000'000'000).value_or(random ? 1 : 0);
  fill.spacing = table.quantity("spacing", dimension::length, range::above(0)).value_or(0);
  fill.shift = table.quantity("shift", dimension::length, range::at_least(0)).value_or(0);
  for (const char* key : {"spacing", "shift"})
    if (random && table.has(key))
      table.fail(key, fmt::format("{} is for sites, but {} is \"random\"; set it to \"simple-cubic\", "
                                  "\"hexagonal\" or \"layers\", or remove the key",
                                  table.path(key), table.path("arrangement")));
}

/// When a fill is applied again.
void read_inflow(TableReader& table, FillSpec& fill) {
  fill.every = table.integer("every", 1).value_or(0);
  fill.until = table.quantity("until", dimension::time, range::at_least(0)).value_or(fill.until);
  if (table.has("every") && !table.has("box")) table.missing("box", "where the bodies come in: two corners");
  if (table.has("until") && !table.has("every"))
    table.fail("until", fmt::format("{} is for a fill that is applied again and again; give {}, or remove "
                                    "the key",
                                    table.path("until"), table.path("every")));
}

}  // namespace

void read_fills(TableReader& root, Case& scene) {
  for (TableReader& table : root.tables("fill")) {
    FillSpec fill;
    fill.shape = read_shape_name(table, scene);
    fill.material = read_material_name(table, scene.material_names);
    fill.kind = read_kind(table, fill.shape, scene);
    fill.density = read_density(table);
    fill.arrangement = table.choice("arrangement", arrangement_names).value_or(fill.arrangement);
    read_sites(table, fill);
    fill.gap = table.quantity("gap", dimension::length, range::at_least(0)).value_or(fill.gap);
    fill.seed = static_cast<std::uint64_t>(table.integer("seed", 0).value_or(1));
    fill.random_orientation =
        table.choice("orientation", {"random", "aligned"}).value_or("random") == "random";
    fill.velocity = table.vector("velocity", dimension::velocity).value_or(fill.velocity);
    read_inflow(table, fill);
    read_box(table, scene.cells, fill.lower, fill.upper);
    scene.fills.push_back(fill);
  }
}

void read_outflows(TableReader& root, Case& scene) {
  for (TableReader& table : root.tables("outflow")) {
    OutflowSpec outflow;
    if (!table.has("box")) table.missing("box", "where bodies are taken out: two corners");
    read_box(table, scene.cells, outflow.lower, outflow.upper);
    scene.outflows.push_back(outflow);
  }
}

}  // namespace silt::coupler
