// [[bodies]], [[fill]] and [[outflow]].
#include <fmt/format.h>

#include <algorithm>
#include <map>

#include "rigid/shapes/shape.hpp"
#include "silt/case/case_sections.hpp"

namespace silt {
namespace {

using rigid::Vec3;

constexpr std::tuple shape_name_keys{
    HandKey{"shape", "string", "", required, "the name of one of [[shapes]]"}};
/// The keys common to entries of [[bodies]] and [[fill]].
constexpr std::tuple entry_keys{
    HandKey{"material", "string", "", "\"default\"", "a name that [[material_pairs]] contains"},
    HandKey{"name", "string", "", "the shape's",
            "kind of the bodies in output; entries of one name make one kind and have one shape"},
    Key{"density", &EntrySpec::density, Number{dimension::density, range::above(0)},
        "density of the bodies, in the units of the case", required}};

constexpr std::tuple body_keys{
    HandKey{"position", "[x, y, z]", "m", "one of two",
            "position of the point of the body that origin selects"},
    HandKey{"positions", "[[x, y, z], …], string, table", "m", "one of two",
            "the same for several bodies; or a file of them in the directory of the case, see below"},
    HandKey{"diameter", "table", "", "the shape's",
            "sizes that a fill gave to bodies of initial.from: the table diameter of that fill"},
    HandKey{"origin", "\"shape\", \"centre\"", "", "\"shape\"",
            "the point of the body that positions refer to: the origin of the shape (or its file), or the "
            "centre of mass"},
    HandKey{"motion", "\"free\", \"fixed\", \"prescribed\", table", "", "\"free\"",
            "whether a body moves by the forces on it, does not move, keeps its velocity, or moves as a "
            "table prescribes: see walls.motion"},
    HandKey{"locked", "list of axes", "", "none",
            "of free bodies: axes along or about which no force moves them, as in [\"x\", \"rotation y\"]"},
    Key{"velocity", &EntrySpec::velocity, Vector{dimension::velocity},
        "initial velocity; not for fixed bodies"},
    Key{"angular_velocity", &BodySpec::angular_velocity, Vector{dimension::angular_velocity},
        "initial angular velocity, in radians per unit of time; not for fixed bodies"}};

constexpr std::tuple file_keys{
    HandKey{"file", "string", "", required,
            "CSV file, or HDF5 file and dataset, in the directory of the case"},
    Key{"position", &rigid::Pose::position, Vector{dimension::length}, "where the origin of the file is"}};

constexpr std::tuple start_keys{
    Key{"from", &StartSpec::from, Text{},
        "folder of another run's results, whose newest checkpoint is used, or a checkpoint", required},
    Key{"position", &StartSpec::position, Vector{dimension::length},
        "of a run without a fluid: where its origin lies, as for a bed in a longer channel"}};

constexpr auto is_at_random = [](const FillSpec& fill) { return fill.arrangement == Arrangement::random; };
constexpr Rule of_sites{If::refused, is_at_random,
                        "{key} is for sites, but {table}.arrangement is \"random\"; set it to "
                        "\"simple-cubic\" or \"hexagonal\", or remove the key"};
constexpr std::tuple fill_keys{
    Key{"arrangement", &FillSpec::arrangement, Choice{arrangement_names}, "where the bodies are"},
    HandKey{"diameter", "table", "", "the shape's",
            "sizes of the bodies, see below, instead of the size of the shape; only at random"},
    Key{"count", &FillSpec::count, Whole{1, 100'000'000'000},
        "number of bodies; by default as many as fit, unless at random", "–, none",
        Rule{If::needed, is_at_random}},
    Key{"spacing", &FillSpec::spacing, Number{dimension::length, range::above(0)},
        "distance between neighbouring sites; not at random", "the least", of_sites},
    Key{"shift", &FillSpec::shift, Number{dimension::length, range::at_least(0)},
        "largest displacement of a body from its site, in a random direction; not at random", nullptr,
        of_sites},
    Key{"gap", &FillSpec::gap, Number{dimension::length, range::at_least(0)},
        "least distance between bounding spheres, and to walls"},
    Key{"seed", &FillSpec::seed, Whole{0}, "seed of the random numbers", nullptr,
        Rule{If::idle,
             [](const FillSpec& fill) { return !is_at_random(fill) && fill.aligned && fill.shift == 0; },
             "nothing of the fill is random; remove it"}},
    Key{"orientation", &FillSpec::aligned, Choice{coupler::names_of<bool>("random", "aligned")},
        "whether the bodies are rotated at random"},
    Key{"box", &FillSpec::box, Corners{}, "two corners of the box that is filled", "the domain"},
    Key{"velocity", &EntrySpec::velocity, Vector{dimension::velocity},
        "velocity of the bodies when they are placed"},
    Key{"every", &FillSpec::every, Whole{1, Whole{}.high, "steps"},
        "steps between two applications; box must then be given", "none"}};

constexpr std::tuple outflow_keys{
    Key{"box", &OutflowSpec::box, Corners{}, "box that removes bodies: two corners", required}};

// Entries of one name form a kind of one shape; the default name is the shape's.
int read_kind(TableReader& table, int shape, Case& setup) {
  const std::string fallback = setup.shape_names.empty() ? "body" : setup.shape_names[shape];
  const std::string name = table.string("name").value_or(fallback);
  const auto found = std::ranges::find(setup.kind_names, name);
  const int kind = static_cast<int>(found - setup.kind_names.begin());
  if (found == setup.kind_names.end()) {
    if (constexpr std::size_t most = 4000;
        setup.kind_names.size() == most)  // the limit of a table of bodies.h5
      table.fail("name", "there are more than {} names of bodies; give several the same one", most);
    setup.kind_names.push_back(name);
    setup.kind_shapes.push_back(shape);
  } else if (setup.kind_shapes[kind] != shape) {
    table.fail("name",
               "{}: another entry of the name '{}' has the shape '{}', this one '{}'; entries of one name "
               "have one shape: give them different names",
               table.path(), name, setup.shape_names[setup.kind_shapes[kind]], setup.shape_names[shape]);
  }
  return kind;
}

void read_entry(TableReader& table, EntrySpec& spec, Case& setup) {
  table.need("shape", "the name of one of [[shapes]]: " + joined(setup.shape_names));
  spec.shape = read_name(table, "shape", setup.shape_names, "shape").value_or(0);
  read_keys(table, spec, entry_keys);
  spec.material = read_name(table, "material", setup.material_names, "material").value_or(0);
  spec.kind = read_kind(table, spec.shape, setup);
}

/// Refuses keys of which a file of positions has columns.
void check_contents(TableReader& table, const std::string& name, const PositionContents& in) {
  for (const auto& [key, in_file] :
       {std::pair("orientation", in.orientation), std::pair("velocity", in.velocity),
        std::pair("angular_velocity", in.angular_velocity)})
    if (in_file && table.has(key))
      table.fail(key, "{} is given, and '{}' has columns of it: remove one of the two", table.path(key),
                 name);
}

/// Positions in a file: only how many there are is looked at, and how fast the fastest are. The key names it,
/// or is a table that does and says where it is. Fixed bodies take no velocities from it.
void read_filed_bodies(TableReader& table, BodySpec alike, Case& setup) {
  std::optional<rigid::Pose> placed;
  TableReader where = table;
  const bool is_table = table.find("positions")->kind == Node::Kind::table;
  if (is_table) {
    where = table.table("positions");
    read_keys(where, placed.emplace(), file_keys);
    placed->orientation = read_orientation(where);
  }
  with_file(where, is_table ? "file" : "positions", true,
            [&](const std::string& name, const AttachedFile& file) {
              PositionContents in = file.positions;
              if (alike.motion == rigid::Motion::fixed) in.velocity = in.angular_velocity = false;
              check_contents(table, name, in);
              const auto fastest = [&](const ColumnGroup& group, Dimension dimension) -> Vec3 {
                return Vec3(&in.fastest[group.begin]) / setup.units.scale(dimension);
              };
              if (in.velocity) alike.velocity = fastest(velocity_columns, dimension::velocity);
              if (in.angular_velocity)
                alike.angular_velocity = fastest(turn_columns, dimension::angular_velocity);
              setup.filed.push_back({alike, placed, position_file(name), in});
            });
}

std::vector<Vec3> read_positions(TableReader& table) {
  const std::string given = table.one_of({"position", "positions"}, true, "where the body is");
  if (given == "positions")
    return table.points(given, 1, std::size_t(-1),
                        "a list of positions, [[x, y, z], ...], or the name of a file of them");
  const auto x = table.vector("position", dimension::length);
  return x ? std::vector{*x} : std::vector<Vec3>{};
}

/// Returns the point of a shape that positions refer to, from its centre of mass.
Vec3 read_origin(TableReader& table, int shape, const Case& setup) {
  const bool centre = table.choice("origin", {"shape", "centre"}) == "centre";
  return centre || setup.shapes.empty() ? Vec3(Vec3::Zero()) : setup.shape_origins[shape];
}

/// Reads the axes along and about which a free body is locked; equal for all bodies of a kind.
void read_locked(TableReader& table, BodySpec& body, const Case& setup,
                 std::map<int, rigid::LockedAxes>& locks_of_kinds) {
  static const std::vector<std::string> axes{"x", "y", "z", "rotation x", "rotation y", "rotation z"};
  for (const int axis : read_names(table, "locked", axes, "axis"))
    body.locked = static_cast<rigid::LockedAxes>(body.locked | 1 << axis);
  const auto unfit = [&](const std::string& what, const char* cure) {
    table.fail("locked", "{}: {}; {}", table.path("locked"), what, cure);
  };
  if (locks_of_kinds.try_emplace(body.kind, body.locked).first->second != body.locked)
    unfit("another entry of the name '" + setup.kind_names[body.kind] + "' is locked otherwise",
          "give them different names");
  if (!body.locked) return;
  if (body.motion != rigid::Motion::free) unfit("the body is not free", "remove the key, or motion");
  if (const ContactSpec& c = setup.contacts; c.resolver_settings.impact_sweeps > 0 || c.resolver != "sffd")
    unfit("the contact resolver is not sffd without an impact phase, which alone knows locked axes",
          "set contacts.resolver = \"sffd\" and contacts.impact_sweeps = 0");
  for (int d = 0; d < 3; ++d)
    if (body.locked & rigid::locked_about(d) && body.angular_velocity[d] != 0)
      unfit("angular_velocity turns the body about a locked axis", "make that component 0");
}

/// Reads a name, or a table of a motion over time, which is common to the bodies of a kind.
void read_body_motion(TableReader& table, BodySpec& body, Case& setup) {
  const Node* const node = table.find("motion");
  if (!node || node->kind != Node::Kind::table) {
    body.motion = table.choice("motion", motion_names).value_or(rigid::Motion::free);
  } else {
    body.motion = rigid::Motion::prescribed;
    TableReader motion = table.table("motion");
    motion.refuse_given({"point"},
                        "{key} is of a wall; a body turns about its centre of mass, remove the key");
    table.refuse_given({"velocity", "angular_velocity"},
                       "{key} is given, and so is the table {table}.motion; remove one of them");
    const rigid::PrescribedMotion& read = setup.kind_motions[body.kind] = read_motion(motion).motion;
    if (read.angular_velocity.isZero(0)) motion.idle("axis", "the body turns about no axis; remove it");
  }
  const auto other = std::ranges::find_if(setup.bodies, [&](const BodySpec& b) {
    return b.kind == body.kind && b.motion == rigid::Motion::prescribed;
  });
  if (body.motion == rigid::Motion::prescribed && setup.kind_motions.count(body.kind) &&
      other != setup.bodies.end())
    table.fail("motion", "{}: another entry of the name '{}' has a motion too; give them different names",
               table.path("motion"), setup.kind_names[body.kind]);
}

using Sizes = std::vector<std::vector<SizeShare>>;

/// Returns the sizes of the bodies that continue another run, a list an entry.
Sizes read_given_bodies(TableReader& root, Case& setup) {
  Sizes sizes;
  int entry = 0;
  std::map<int, rigid::LockedAxes> locks;  // by kind
  for (TableReader& table : root.tables("bodies")) {
    BodySpec body;
    body.entry = entry++;
    read_entry(table, body, setup);
    read_keys(table, body, body_keys);
    read_body_motion(table, body, setup);
    read_locked(table, body, setup, locks);
    body.pose.orientation = read_orientation(table);
    body.origin = read_origin(table, body.shape, setup);
    if (body.motion == rigid::Motion::fixed)
      table.refuse_given({"velocity", "angular_velocity"},
                         "{key} is given for a fixed body; remove it, or set motion = \"prescribed\"");
    const Node* positions = table.find("positions");
    const bool named =
        positions && (positions->kind == Node::Kind::string || positions->kind == Node::Kind::table);
    if (named && !table.has("position")) {
      read_filed_bodies(table, body, setup);
      continue;
    }
    if (setup.start && !table.has("position") && !table.has("positions")) {
      table.refuse_given({"velocity", "angular_velocity", "orientation", "origin"},
                         "{key} has no effect: an entry without position names bodies of initial.from, which "
                         "go on as they were there; remove it, or give a position to add a body");
      setup.continued.push_back({body, {}});
      sizes.push_back(read_fill_sizes(table));
      continue;
    }
    table.refuse_given({"diameter"},
                       "{key} is of bodies of initial.from, which have no position here; the size of "
                       "others is that of their shape, remove the key");
    for (const Vec3& position : read_positions(table)) {
      put_at(body, position, extent_of(setup));
      setup.bodies.push_back(body);
    }
  }
  for (const auto& [kind, locked] : locks)
    if (locked) setup.kind_locks.resize(setup.kind_names.size()), setup.kind_locks[kind] = locked;
  return sizes;
}

/// Rejects contradictory keys.
void judge_fill(TableReader& table, const FillSpec& fill) {
  if (!is_at_random(fill) && table.has("diameter"))
    table.fail("diameter", "{} is for bodies at random places, but {} is \"{}\"; remove one of the two",
               table.path("diameter"), table.path("arrangement"), arrangement_names[fill.arrangement]);
  if (table.has("every")) table.need("box", "the box in which bodies enter: two corners");
}

}  // namespace

std::vector<KeySection> body_sections() {
  return {section_of("initial", start_keys),
          section_of("bodies", shape_name_keys, entry_keys, body_keys, orientation_keys, wall_heat_keys,
                     lump_keys),
          section_of("bodies.positions", file_keys, orientation_keys),
          section_of("fill", shape_name_keys, entry_keys, fill_keys, wall_heat_keys, lump_keys),
          fill_size_section(),
          section_of("outflow", outflow_keys)};
}

void read_bodies(TableReader& root, Case& setup) {
  if (TableReader start = root.table("initial"); start.present())
    read_keys(start, setup.start.emplace(), start_keys);
  const Sizes of_continued = read_given_bodies(root, setup);
  Sizes sizes;
  for (TableReader& table : root.tables("fill")) {
    FillSpec& fill = setup.fills.emplace_back();
    fill.box = box_of(setup);
    read_entry(table, fill, setup);
    read_keys(table, fill, fill_keys);
    judge_fill(table, fill);
    if (static_cast<std::size_t>(fill.kind) < setup.kind_locks.size() && setup.kind_locks[fill.kind])
      table.fail("name",
                 "{}: bodies of the name '{}' are locked, those of a fill are not; give them another name",
                 table.path(), setup.kind_names[fill.kind]);
    sizes.push_back(read_fill_sizes(table));
  }
  if (!setup.kind_locks.empty()) setup.kind_locks.resize(setup.kind_names.size());
  // after all that name a shape: those of sizes have the names of others
  set_fill_sizes(setup, sizes, of_continued);
  for (TableReader& table : root.tables("outflow")) {
    OutflowSpec& outflow = setup.outflows.emplace_back();
    read_keys(table, outflow, outflow_keys);
    outflow.box.upper = snapped(outflow.box.upper, setup.cells);
  }
}

}  // namespace silt
