// [[walls]]; surfaces from files, for walls and [[shapes]]; prescribed motions of walls.
#include <fmt/format.h>

#include <array>
#include <numbers>
#include <sstream>
#include <stdexcept>

#include "adapters/mesh/read_mesh.hpp"
#include "rigid/shapes/shape.hpp"
#include "silt/case/case_sections.hpp"
#include "silt/case/csv_reader.hpp"

namespace silt {

MotionFile read_motion_file(const std::string& text, const Units& units) {
  std::istringstream stream(text);
  CsvReader reader(stream);
  MotionFile file{{}, static_cast<int>(reader.headings().size())};
  const double length = units.lattice(1, dimension::length);
  while (reader.next()) {
    std::array<double, 7> x;
    try {
      reader.numbers(x,
                     "seven finite numbers with commas between them: time, displacement x, y, z, rotation "
                     "vector x, y, z");
    } catch (const std::invalid_argument& error) {
      throw std::invalid_argument(fmt::format("line {} {}", reader.lines(), error.what()));
    }
    const double time = units.lattice(x[0], dimension::time);
    if (!file.rows.empty() && !(time > file.rows.back().time))
      throw std::invalid_argument(
          fmt::format("line {}: its time is not after that of the line before", reader.lines()));
    file.rows.push_back({time, length * rigid::Vec3(x[1], x[2], x[3]), {x[4], x[5], x[6]}});
  }
  if (file.rows.size() < 2) throw std::invalid_argument("it must have two lines of numbers or more");
  return file;
}

namespace {

using rigid::PrescribedMotion;
using rigid::TubeWallSpec;
using rigid::Vec3;

std::string contents_of(const adapters::ReadMesh& read) {
  std::string text = fmt::format("{} triangles in {} {}", read.surface->triangles().size(),
                                 read.closed.shells, read.closed.shells == 1 ? "shell" : "shells");
  struct {
    std::size_t count;
    const char *one, *several;
  } const more[] = {{read.closed.hollows, "of them a hollow", "of them hollows"},
                    {read.welded.degenerate, "degenerate triangle left out", "degenerate triangles left out"},
                    {read.welded.duplicate, "duplicate triangle left out", "duplicate triangles left out"},
                    {read.welded.thin, "triangle of fins and membranes left out",
                     "triangles of fins and membranes left out"},
                    {read.closed.turned, "triangle turned over", "triangles turned over"}};
  for (const auto& [count, one, several] : more)
    if (count > 0) text += fmt::format(", {} {}", count, count == 1 ? one : several);
  return text;
}

constexpr HandKey rpm_key{"rpm", "number", "1/min", "0",
                          "revolutions per minute, instead of angular_velocity; only with \"si\""};
constexpr std::tuple wall_keys{
    HandKey{"type", "\"tube\", \"mesh\"", "", required, "kind of wall: \"tube\" or \"mesh\""},
    HandKey{"name", "string", "", "its path", "name of the wall in quantities"},
    HandKey{"material", "string", "", "\"default\"", "a name that [[material_pairs]] contains"}};
constexpr std::tuple tube_keys{
    HandKey{"radius", "number", "m", "one of two", "of a tube: its size"},
    HandKey{"diameter", "number", "m", "one of two", "of a tube: its size"},
    HandKey{"axis", "\"x\", \"y\", \"z\", [x, y, z]", "", required,
            "direction of the tube: \"x\", \"y\", \"z\" or [x, y, z]"},
    Key{"point", &TubeWallSpec::point, Vector{dimension::length}, "a point of the tube's axis, [x, y, z]",
        required},
    Key{"angular_velocity", &TubeWallSpec::angular_velocity, Number{dimension::angular_velocity},
        "rotation of the tube about the axis (a drum), in radians per unit of time"},
    rpm_key};
constexpr std::tuple mesh_file_keys{HandKey{
    "file", "string", "", required, "the name of an STL, OBJ or PLY file in the directory of the case"}};
constexpr std::tuple mesh_keys{
    HandKey{"solid", "\"inside\", \"outside\"", "", required,
            "\"inside\" of the surface, or \"outside\" (a vessel)"},
    HandKey{"scale", "number", "1", "1", "unit of length of the file in that of the case"},
    HandKey{"position", "[x, y, z]", "m", "0", "where the origin of the file is"},
    HandKey{"motion", "table", "", "at rest", "of a mesh, see below"}};
constexpr std::tuple motion_keys{
    Key{"velocity", &PrescribedMotion::velocity, Vector{dimension::velocity}, "velocity of the point"},
    HandKey{"angular_velocity", "number", "1/s", "0",
            "rotation about the axis through the moving point, in radians per unit of time"},
    rpm_key,
    HandKey{"axis", "\"x\", \"y\", \"z\", [x, y, z]", "", "z at rest", "of the rotation, and of wall-torque"},
    HandKey{"point", "[x, y, z]", "m", "position",
            "of the axis of a wall, at the start; wall-torque is about it"},
    Key{"amplitude", &PrescribedMotion::amplitude, Vector{dimension::length},
        "of an oscillation of the point: amplitude × sin(2π frequency t)", nullptr,
        Rule{If::idle, is_zero(&PrescribedMotion::frequency), "the frequency is 0; give one"}},
    Key{"frequency", &PrescribedMotion::frequency, Number{dimension::angular_velocity, range::at_least(0)},
        "oscillations per unit of time: cycles, not radians", "with amplitude",
        Rule{If::idle, is_zero(&PrescribedMotion::amplitude), "the amplitude is 0; give one, or remove it"},
        Rule{If::needed,
             [](const PrescribedMotion& s) { return !is_zero(&PrescribedMotion::amplitude)(s); }}},
    HandKey{"table", "string", "", "none", "CSV file of a motion, instead of angular_velocity"}};

/// Returns the angular velocity, in radian a step, that `rpm` gives; none without it.
std::optional<double> read_rpm(TableReader& table) {
  const auto rpm = table.number("rpm", range::any);
  const Units& units = table.context().units;
  if (rpm && table.context().units_known && !units.si)
    table.fail("rpm",
               "{} is given, but lattice units have no minutes; give angular_velocity, in radians per step",
               table.path("rpm"));
  return rpm ? std::optional(units.lattice(*rpm * std::numbers::pi / 30, dimension::angular_velocity)) : rpm;
}

/// Calls use(surface, name) for the surface in `file`, read by read(name, bytes, lattice units in one of the
/// file's) and warns of one whose numbers do not keep it: its origin is far away.
template <class Read, class Use>
void with_surface(TableReader& table, Read&& read, Use&& use) {
  constexpr double enough = 0.1;  // cells
  const double scale = table.number("scale", range::above(0)).value_or(1) / table.context().units.cell_size;
  with_file(table, "file", false, [&](const std::string& name, const AttachedFile& file) {
    const auto surface = read(name, file.bytes, scale);
    if (surface.coordinate_step > enough)
      table.warn("file",
                 "{}: '{}' keeps its coordinates in single precision, which are {} cells apart so far from "
                 "its origin; save it in double precision or as text, or with its origin near the surface",
                 table.path("file"), name, shown(surface.coordinate_step));
    use(surface, name);
  });
}

/// Reads "x", "y", "z" or a vector as a unit vector; `what` describes it.
Vec3 read_direction(TableReader& table, std::string_view what) {
  table.need("axis", fmt::format("{}: \"x\", \"y\", \"z\" or [x, y, z]", what));
  const Node* node = table.find("axis");
  if (!node) return Vec3::UnitZ();
  if (node->kind == Node::Kind::string) {
    const auto name = table.choice("axis", {"x", "y", "z"});
    return Vec3::Unit(name ? (*name)[0] - 'x' : 2);
  }
  const Vec3 axis = table.vector("axis").value_or(Vec3::UnitZ());
  if (axis.norm() > 0) return axis.normalized();
  table.refuse("axis", "\"x\", \"y\", \"z\" or a direction [x, y, z] that is not zero");
  return Vec3::UnitZ();
}

MeshWall read_mesh_wall(TableReader& table) {
  MeshWall wall;
  read_keys(table, wall, mesh_file_keys);
  read_keys(table, wall, mesh_keys);
  const Vec3 position = table.vector("position", dimension::length).value_or(Vec3::Zero());
  const rigid::Quat orientation = read_orientation(table);
  const bool hollow = table.choice("solid", {"inside", "outside"}) == "outside";
  TableReader motion = table.table("motion");
  ReadMotion read = read_motion(motion);
  const Vec3 point = motion.vector("point", dimension::length).value_or(position);
  wall.motion = std::move(read.motion), wall.axis = read.axis;
  wall.table = read.table, wall.table_headings = read.table_headings;
  wall.start = {point, orientation};
  with_surface(table, adapters::read_mesh, [&](const adapters::ReadMesh& mesh, const std::string& name) {
    wall.file = name, wall.contents = contents_of(mesh);
    const Vec3 middle = 0.5 * (mesh.surface->box().lower + mesh.surface->box().upper);
    wall.mesh = rigid::Mesh{mesh.surface, hollow}.recentred(middle);
    wall.arm = middle - orientation.conjugate() * (point - position);
  });
  return wall;
}

TubeWallSpec read_tube_wall(TableReader& table) {
  TubeWallSpec wall{read_tube(table)};
  read_keys(table, wall, tube_keys);
  table.one_of({"angular_velocity", "rpm"}, false, "");
  wall.angular_velocity = read_rpm(table).value_or(wall.angular_velocity);
  if (table.has("axis")) wall.axis = read_direction(table, "");
  return wall;
}

}  // namespace

ReadMotion read_motion(TableReader& table) {
  ReadMotion read;
  if (!table.present()) return read;
  PrescribedMotion& motion = read.motion;
  read_keys(table, motion, motion_keys);
  const std::string turn = table.one_of({"angular_velocity", "rpm", "table"}, false, "");
  if (turn == "angular_velocity" || turn == "rpm" || table.has("axis"))
    read.axis = read_direction(table, "of its rotation");
  const auto given = table.quantity("angular_velocity", dimension::angular_velocity, range::any);
  motion.angular_velocity = read_rpm(table).value_or(given.value_or(0)) * read.axis;
  if (turn == "table")
    with_file(table, "table", false, [&](const std::string& name, const AttachedFile& file) {
      MotionFile rows = read_motion_file(file.bytes, table.context().units);
      read.table = name, read.table_headings = rows.headings;
      motion.table = std::move(rows.rows);
    });
  return read;
}

rigid::Shape read_mesh_body(TableReader& table, Case& setup) {
  require(table, std::get<0>(mesh_file_keys));
  rigid::Shape shape = rigid::Sphere{1};
  with_surface(table, adapters::read_mesh, [&](const adapters::ReadMesh& read, const std::string& name) {
    setup.meshes[setup.shape_names.back()] = {name, contents_of(read)};
    shape = rigid::Mesh{read.surface, false};
  });
  return shape;
}

std::shared_ptr<const rigid::PolyhedronMesh> read_polyhedron_file(TableReader& table) {
  std::shared_ptr<const rigid::PolyhedronMesh> mesh;
  with_surface(table, adapters::read_polyhedron,
               [&](const adapters::ReadPolyhedron& read, const std::string&) { mesh = read.mesh; });
  return mesh;
}

std::vector<KeySection> wall_sections() {
  return {
      section_of("walls", wall_keys, tube_keys, mesh_file_keys, mesh_keys, orientation_keys, wall_heat_keys),
      section_of("walls.motion", motion_keys)};
}

void read_walls(TableReader& root, Case& setup) {
  std::vector<std::string> names;
  const std::vector<std::string> types{std::string(rigid::Tube::name), std::string(rigid::Mesh::name)};
  for (TableReader& table : root.tables("walls")) {
    CurvedWall wall;
    read_keys(table, wall, wall_keys);
    const auto type = table.choice("type", types);
    wall.name = read_new_name(table, names, "wall", table.path());
    const int material = read_name(table, "material", setup.material_names, "material").value_or(0);
    if (type == rigid::Mesh::name) {
      MeshWall mesh = read_mesh_wall(table);
      if (mesh.mesh.surface) wall.surface = std::move(mesh);  // else the fault has been reported
    } else if (type) {
      wall.surface = read_tube_wall(table);
    } else {
      table.judge_no_keys();
    }
    std::visit([&](auto& of_kind) { of_kind.material = material; }, wall.surface);
    setup.walls.push_back(std::move(wall));
  }
}

}  // namespace silt
