// [[bodies]], [[fill]] and [[outflow]]; what may be wrong with bodies that come and go.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "coupler/case/case.hpp"
#include "coupler/case/case_check.hpp"
#include "coupler/case/case_file.hpp"
#include "coupler/case/case_sections.hpp"
#include "rigid/shapes/shape.hpp"

namespace silt::coupler {

namespace {

using rigid::Vec3;

constexpr std::tuple shape_name_keys{
    HandKey{"shape", "string", "", required, "the name of one of [[shapes]]"}};
/// What entries of [[bodies]] and [[fill]] have in common.
template <class Spec>
constexpr std::tuple entry_keys{
    HandKey{"material", "string", "", "\"default\"", "name of one of [[materials]]"},
    HandKey{"name", "string", "", "the shape's",
            "kind of the bodies in output; entries of one name make one kind and have one shape"},
    Key{"density", &Spec::density, Number{dimension::density, range::above(0)},
        "density of the bodies, in the units of the case", required}};

constexpr std::tuple body_keys{
    HandKey{"position", "[x, y, z]", "m", "one of two", "where the point of the body is that origin names"},
    HandKey{"positions", "[[x, y, z], …], string", "m", "one of two",
            "the same of several bodies; or a file of them in the directory of the case, see below"},
    HandKey{"origin", "\"shape\", \"centre\"", "", "\"shape\"",
            "what the positions place: the origin that the shape (or its file) is given about, or the centre "
            "of mass"},
    Key{"motion", &BodySpec::motion, Choice{motion_names},
        "whether a body moves by the forces on it, not at all, or keeps its velocity"},
    Key{"velocity", &BodySpec::velocity, Vector{dimension::velocity},
        "velocity at the start; not of a fixed body"},
    Key{"angular_velocity", &BodySpec::angular_velocity, Vector{dimension::angular_velocity},
        "angular velocity at the start; not of a fixed body"}};

constexpr const char* two_corners = "[[x, y, z], [x, y, z]]";
constexpr std::tuple fill_keys{
    Key{"arrangement", &FillSpec::arrangement, Choice{arrangement_names}, "where the bodies are"},
    Key{"count", &FillSpec::count, Whole{1, 100'000'000'000},
        "number of bodies; not at random as many as fit without it", "–, none"},
    Key{"spacing", &FillSpec::spacing, Number{dimension::length, range::above(0)},
        "distance of neighbouring sites; not at random", "the least"},
    Key{"shift", &FillSpec::shift, Number{dimension::length, range::at_least(0)},
        "furthest that a body is moved from its site, in a random direction; not at random"},
    Key{"gap", &FillSpec::gap, Number{dimension::length, range::at_least(0)},
        "least distance between bounding spheres, and to walls"},
    Key{"seed", &FillSpec::seed, Whole{0}, "seed of the random numbers"},
    Key{"orientation", &FillSpec::aligned, Choice{names_of<bool>("random", "aligned")},
        "whether the bodies are rotated at random"},
    HandKey{"box", two_corners, "m", "the domain", "two corners of the box that is filled"},
    Key{"velocity", &FillSpec::velocity, Vector{dimension::velocity},
        "velocity of the bodies when they are placed"},
    Key{"every", &FillSpec::every, Whole{1, Whole{}.high, "steps"},
        "steps between two applications; box must then be given", "none"},
    Key{"until", &FillSpec::until, Number{dimension::time, range::at_least(0)},
        "time after which it is not applied again", "the end"}};

constexpr std::tuple outflow_keys{
    HandKey{"box", two_corners, "m", required, "where bodies are taken out: two corners"}};

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
      table.fail("name", "there are more than {} names of bodies; give several the same one", most);
    scene.kind_names.push_back(name);
    scene.kind_shapes.push_back(shape);
  } else if (scene.kind_shapes[kind] != shape) {
    table.fail("name",
               "{}: another entry of the name '{}' has the shape '{}', this one '{}'; entries of one name "
               "have one shape: give them different names",
               table.path(), name, scene.shape_names[scene.kind_shapes[kind]], scene.shape_names[shape]);
  }
  return kind;
}

template <class Spec>
void read_entry(TableReader& table, Spec& spec, Case& scene) {
  spec.shape = read_shape_name(table, scene);
  read_keys(table, spec, entry_keys<Spec>);
  spec.material = read_material_name(table, scene.material_names);
  spec.kind = read_kind(table, spec.shape, scene);
}

/// What a file of positions says as well must not be given by a key, nor be what a fixed body cannot have.
void check_contents(TableReader& table, const BodySpec& body, const std::string& name,
                    const PositionContents& in) {
  const auto refuse_twice = [&](bool in_file, std::initializer_list<const char*> keys) {
    for (const char* key : keys)
      if (in_file && table.has(key))
        table.fail(key, "{} is given, and '{}' has columns of it: remove one of the two", table.path(key),
                   name);
  };
  refuse_twice(in.orientation, {"orientation", "axis_angle", "axis"});
  refuse_twice(in.velocity, {"velocity"});
  refuse_twice(in.angular_velocity, {"angular_velocity"});
  const std::array<double, 3> none = {};
  if (body.motion == rigid::Motion::fixed && (in.fastest != none || in.fastest_turn != none))
    table.fail("positions",
               "{}: '{}' has velocities, but the bodies are fixed; set motion = \"free\" or \"prescribed\", "
               "or remove these columns",
               table.path("positions"), name);
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
    table.fail("positions", "{}: '{}': {}", table.path("positions"), *name, error.what());
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

void read_bodies(TableReader& root, Case& scene) {
  int entry = 0;
  for (TableReader& table : root.tables("bodies")) {
    BodySpec body;
    body.entry = entry++;
    read_entry(table, body, scene);
    read_keys(table, body, body_keys);
    body.pose.orientation = read_orientation(table);
    body.origin = read_origin(table, body.shape, scene);
    for (const char* key : {"velocity", "angular_velocity"})
      if (body.motion == rigid::Motion::fixed && table.has(key))
        table.fail(key, "{} is given for a fixed body; remove it, or set motion = \"prescribed\"",
                   table.path(key));
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

/// Refuses what does not go together.
void judge_fill(TableReader& table, const FillSpec& fill) {
  const bool random = fill.arrangement == Arrangement::random;
  if (random && !table.has("count")) table.missing("count", "how many bodies to place");
  for (const char* key : {"spacing", "shift"})
    if (random && table.has(key))
      table.fail(key,
                 "{} is for sites, but {} is \"random\"; set it to \"simple-cubic\", \"hexagonal\" or "
                 "\"layers\", or remove the key",
                 table.path(key), table.path("arrangement"));
  if (table.has("every") && !table.has("box")) table.missing("box", "where the bodies come in: two corners");
  if (table.has("until") && !table.has("every"))
    table.fail("until", "{} is for a fill that is applied again and again; give {}, or remove the key",
               table.path("until"), table.path("every"));
}

}  // namespace

std::vector<KeySection> body_sections() {
  return {section_of("bodies", shape_name_keys, entry_keys<BodySpec>, body_keys, orientation_keys),
          section_of("fill", shape_name_keys, entry_keys<FillSpec>, fill_keys),
          section_of("outflow", outflow_keys)};
}

void read_fills(TableReader& root, Case& scene) {
  for (TableReader& table : root.tables("fill")) {
    FillSpec fill;
    read_entry(table, fill, scene);
    read_keys(table, fill, fill_keys);
    judge_fill(table, fill);
    read_box(table, scene.cells, fill.lower, fill.upper);
    scene.fills.push_back(fill);
  }
}

void read_outflows(TableReader& root, Case& scene) {
  for (TableReader& table : root.tables("outflow")) {
    OutflowSpec outflow;
    read_keys(table, outflow, outflow_keys);
    read_box(table, scene.cells, outflow.lower, outflow.upper);
    scene.outflows.push_back(outflow);
  }
}

namespace {

using rigid::Vec3;

std::string box_text(const Case& scene, const Vec3& lower, const Vec3& upper) {
  return fmt::format("{} to {}", shown_point(scene, lower), shown_point(scene, upper));
}

void check_outflow(const Case& scene, Findings& findings, std::size_t index) {
  const OutflowSpec& outflow = scene.outflows[index];
  const std::string key = fmt::format("outflow[{}].box", index);
  const std::string is = fmt::format("{} is {}", key, box_text(scene, outflow.lower, outflow.upper));
  const Vec3 size = extent_of(scene).size;
  if ((outflow.lower.array() < 0).any() || (outflow.upper.array() > size.array()).any())
    return findings.error(key,
                          "{}; it must lie in the domain, {}; beyond a side that is not solid_for_bodies "
                          "bodies leave without it",
                          is, box_text(scene, Vec3::Zero(), size));
  for (std::size_t i = 0; i < scene.fills.size(); ++i) {
    const FillSpec& fill = scene.fills[i];
    if (fill.every > 0 && (outflow.lower.array() < fill.upper.array()).all() &&
        (fill.lower.array() < outflow.upper.array()).all())
      findings.error(
          key,
          "{}; it meets fill[{}].box, {}, where bodies come in: they would leave at once; move them apart",
          is, i, box_text(scene, fill.lower, fill.upper));
  }
}

/// The step by which a ball that keeps its velocity is wholly beyond a side, and which; infinite if it never
/// is.
struct WayOut {
  double step = std::numeric_limits<double>::infinity();
  int side = 0;
};
WayOut way_out(const Case& scene, const BodySpec& body) {
  const double radius = rigid::bounding_radius(scene.shapes[body.shape]);
  WayOut first;
  for (int d = 0; d < 3; ++d) {
    const double v = body.velocity[d], x = body.pose.position[d];
    if (scene.periodic(d) || v == 0) continue;
    const double step = ((v > 0 ? scene.cells[d] - x : x) + radius) / std::abs(v);
    if (step < first.step) first = {step, 2 * d + (v > 0)};
  }
  return first;
}

/// Bodies of prescribed motion that the case itself moves out of the domain: one message an entry.
void check_prescribed(const Case& scene, Findings& findings) {
  int said_of = -1;
  for (const BodySpec& body : scene.bodies) {
    const WayOut out = way_out(scene, body);
    if (body.motion != rigid::Motion::prescribed || body.entry == said_of ||
        !(out.step < static_cast<double>(scene.steps)))
      continue;
    said_of = body.entry;
    const std::string key = entry_key(body.entry) + ".velocity";
    findings.warning(
        key,
        "{} takes the body out of the domain past {} by step {:.0f} of {}: {}; end the run before, or make "
        "it slower",
        key, side_names[Side(out.side)], std::ceil(out.step), scene.steps,
        scene.boundary[out.side].removes_bodies() ? "it is taken out there" : "the run stops there");
  }
}

}  // namespace

void find_turnover_faults(const Case& scene, Findings& findings) {
  for (std::size_t i = 0; i < scene.outflows.size(); ++i) check_outflow(scene, findings, i);
  check_prescribed(scene, findings);
  const bool any_free = !scene.fills.empty() || scene.any_given([](const BodySpec& body) {
    return body.motion == rigid::Motion::free;
  });
  if (!scene.outflows.empty() && !any_free)
    findings.warning("outflow", "outflow: the case has no free bodies, and no others leave");
  for (std::size_t i = 0; i < scene.fills.size(); ++i) {
    const FillSpec& fill = scene.fills[i];
    const std::string key = fmt::format("fill[{}].every", i);
    if (fill.every == 0) continue;
    if (fill.every >= scene.steps || static_cast<double>(fill.every) > fill.until)
      findings.warning(key, "{} is {}, of {} steps in all{}: bodies come at the start only", key, fill.every,
                       scene.steps,
                       static_cast<double>(fill.every) > fill.until ? " and before `until`" : "");
  }
}

}  // namespace silt::coupler
