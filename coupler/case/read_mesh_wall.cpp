// Surfaces in files: [[walls]] of type "mesh" and where they go; and [[shapes]] of them.
#include <fmt/format.h>

#include <numbers>
#include <stdexcept>

#include "adapters/mesh/read_mesh.hpp"
#include "adapters/mesh/read_polyhedron.hpp"
#include "coupler/case/case_sections.hpp"
#include "coupler/case/case_source.hpp"
#include "coupler/case/motion_file.hpp"
#include "rigid/shapes/shape.hpp"

namespace silt::coupler {
namespace {

using rigid::Pose;
using rigid::Vec3;

/// Calls read(bytes) for the file that the key names; what is wrong with it is reported.
template <class Read>
void with_file(TableReader& table, std::string_view key, Read&& read) {
  const auto name = table.string(key);
  if (!name) return;
  ReadContext& context = table.context();
  try {
    const AttachedFile& file = context.source->file_named(*name);
    context.files.push_back(file.fingerprint);
    read(*name, file.bytes);
  } catch (const std::invalid_argument& error) {
    table.fail(key, fmt::format("{}: '{}': {}", table.path(key), *name, error.what()));
  }
}

std::string contents_of(const adapters::ReadMesh& read) {
  std::string text = fmt::format("{} triangles in {} {}", read.surface->triangles().size(),
                                 read.closed.shells, read.closed.shells == 1 ? "shell" : "shells");
  const auto add = [&](std::size_t count, const char* what) {
    if (count > 0) text += fmt::format(", {} {}", count, what);
  };
  add(read.closed.hollows, "of them hollows");
  add(read.welded.degenerate, "degenerate triangles left out");
  add(read.welded.coincident.duplicate, "duplicate triangles left out");
  add(read.welded.coincident.thin, "triangles of fins and membranes left out");
  add(read.closed.turned, "triangles turned over");
  return text;
}

void read_oscillation(TableReader table, rigid::WallMotion& motion) {
  if (!table.present()) return;
  if (!table.has("amplitude")) table.missing("amplitude", "how far the wall goes to either side, [x, y, z]");
  if (!table.has("frequency")) table.missing("frequency", "oscillations in a unit of time");
  motion.amplitude = table.vector("amplitude", dimension::length).value_or(Vec3::Zero());
  motion.frequency = table.quantity("frequency", dimension::angular_velocity, range::at_least(0)).value_or(0);
  motion.phase = table.number("phase", range::any).value_or(0) * std::numbers::pi / 180;
}

const char* const file_doc = "the name of an STL, OBJ or PLY file in the directory of the case";

/// Of a file whose numbers do not keep its surface: its origin is far away.
void warn_of_steps(TableReader& table, const std::string& name, double coordinate_step) {
  constexpr double enough = 0.1;  // cells
  if (!(coordinate_step > enough)) return;
  table.warn("file",
             fmt::format("{}: '{}' keeps its coordinates in single precision, which are {} cells apart so "
                         "far from its origin; save it in double precision or as text, or with its origin "
                         "near the surface",
                         table.path("file"), name, shown(coordinate_step)));
}

/// Lattice units in one of the file's.
double read_scale(TableReader& table) {
  return table.number("scale", range::above(0)).value_or(1) / table.context().units.cell_size;
}

/// What turns, turns about `point`, which is left as it is without a turn.
void read_motion(TableReader table, MeshWall& wall, Vec3& point) {
  if (!table.present()) return;
  rigid::WallMotion& motion = wall.motion;
  motion.velocity = table.vector("velocity", dimension::velocity).value_or(Vec3::Zero());
  const std::string turn = table.one_of({"angular_velocity", "table"}, false, "");
  if (turn == "angular_velocity" || table.has("axis"))
    wall.axis = read_axis(table, "about which the wall turns");
  point = table.vector("point", dimension::length).value_or(point);
  motion.angular_velocity =
      table.quantity("angular_velocity", dimension::angular_velocity, range::any).value_or(0) * wall.axis;
  read_oscillation(table.table("oscillation"), motion);
  if (turn == "table")
    with_file(table, "table", [&](const std::string& name, const std::string& bytes) {
      MotionFile file = read_motion_file(bytes, table.context().units);
      wall.table = name, wall.table_headings = file.headings;
      motion.table = std::move(file.rows);
    });
}

}  // namespace

MeshWall read_mesh_wall(TableReader& table) {
  MeshWall wall;
  if (!table.has("file")) table.missing("file", file_doc);
  if (!table.has("solid")) table.missing("solid", "\"inside\" of the surface, or \"outside\" (a vessel)");
  const double scale = read_scale(table);
  const Vec3 position = table.vector("position", dimension::length).value_or(Vec3::Zero());
  const rigid::Quat orientation = read_orientation(table);
  const bool hollow = table.choice("solid", {"inside", "outside"}) == "outside";
  Vec3 point = position;
  read_motion(table.table("motion"), wall, point);
  wall.start = {point, orientation};
  with_file(table, "file", [&](const std::string& name, const std::string& bytes) {
    const adapters::ReadMesh read = adapters::read_mesh(name, bytes, scale);
    warn_of_steps(table, name, read.coordinate_step);
    wall.file = name, wall.contents = contents_of(read);
    const Vec3 middle = 0.5 * (read.surface->box().lower + read.surface->box().upper);
    wall.mesh = rigid::Mesh{read.surface, hollow}.recentred(middle);
    wall.arm = middle - orientation.conjugate() * (point - position);
  });
  return wall;
}

rigid::Shape read_mesh_body(TableReader& table) {
  if (!table.has("file")) table.missing("file", file_doc);
  const double scale = read_scale(table);
  rigid::Shape shape = rigid::Sphere{1};
  with_file(table, "file", [&](const std::string& name, const std::string& bytes) {
    const adapters::ReadMesh read = adapters::read_mesh(name, bytes, scale);
    warn_of_steps(table, name, read.coordinate_step);
    const rigid::Mesh mesh{read.surface, false};
    if (!(mesh.mass_properties().volume > 0))
      throw std::invalid_argument("it encloses no volume: a body needs some");
    shape = mesh;
  });
  return shape;
}

std::shared_ptr<const rigid::PolyhedronMesh> read_polyhedron_file(TableReader& table) {
  const double scale = read_scale(table);
  std::shared_ptr<const rigid::PolyhedronMesh> mesh;
  with_file(table, "file", [&](const std::string& name, const std::string& bytes) {
    const adapters::ReadPolyhedron read = adapters::read_polyhedron(name, bytes, scale);
    warn_of_steps(table, name, read.coordinate_step);
    mesh = read.mesh;
  });
  return mesh;
}

}  // namespace silt::coupler
