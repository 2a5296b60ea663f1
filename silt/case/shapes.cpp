// [[shapes]], and the orientation of a part or a body.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <stdexcept>

#include "adapters/qhull/convex_hull.hpp"
#include "rigid/math/elementary.hpp"
#include "rigid/math/types.hpp"
#include "rigid/shapes/shape.hpp"
#include "silt/case/case_sections.hpp"

namespace silt {
namespace {

using rigid::Quat;
using rigid::Vec3;

constexpr std::tuple shape_keys{
    HandKey{"name", "string", "", required, "name of the shape, to which bodies refer"},
    HandKey{"type", "type of shape", "", required,
            "one of those listed in cases/README.md, with its other keys"},
    HandKey{"radius", "number", "m", "one of two", "size of a round shape"},
    HandKey{"diameter", "number", "m", "one of two", "size of a round shape"},
    HandKey{"length", "number", "m", required,
            "of a cylinder from end to end; of a capsule between the centres of its ends; along z"},
    HandKey{"edges", "[x, y, z]", "m", required, "edges of a box"},
    HandKey{"diameters", "[x, y, z]", "m", required, "of an ellipsoid, along its axes"},
    HandKey{"vertices", "[[x, y, z], …]", "m", "one of two", "corners of a convex body, in any order"},
    HandKey{"file", "string", "", "one of two",
            "STL, OBJ or PLY file in the directory of the case, closed, of a polyhedron convex; required of "
            "a mesh; a resumed run needs the same file"},
    HandKey{"scale", "number", "1", "1", "unit of length of the file in that of the case"},
    HandKey{"parts", "list of tables", "", required, "convex parts of a compound, see below"}};
constexpr std::tuple part_keys{Key{"position", &rigid::Pose::position, Vector{dimension::length},
                                   "of the part's origin, in the frame of the shape"}};

/// A rotation that gives an orientation.
struct Turn {
  Vec3 axis = Vec3::Zero();
  double degrees = 0;
};
constexpr std::tuple turn_keys{
    Key{"axis", &Turn::axis, Vector{}, "axis of the rotation, [x, y, z]", required},
    Key{"degrees", &Turn::degrees, Number{dimension::none, range::any, "degrees"}, "angle of the rotation",
        required}};

/// Returns the length; a harmless one if it is missing or wrong (reported).
template <class Solid>
double read_length(TableReader& table, const rigid::Field<Solid, double>& field) {
  std::string given = field.key;
  if (field.other_key)
    given = table.one_of({field.key, field.other_key}, true, field.doc);
  else
    table.need(field.key, field.doc);
  const double share = given == field.key ? field.share : field.other_share;
  return (given.empty() ? 2 : table.quantity(given, dimension::length, range::above(0)).value_or(2)) * share;
}

template <class Solid>
Vec3 read_length(TableReader& table, const rigid::Field<Solid, Vec3>& field) {
  table.need(field.key, field.doc);
  const Vec3 lengths = table.vector(field.key, dimension::length).value_or(Vec3::Ones());
  if (lengths.minCoeff() <= 0) table.refuse(field.key, "above 0 in each direction");
  return field.share * lengths;
}

/// Reads the lengths in the table of fields of a solid.
template <class Solid>
Solid read_sizes(TableReader& table) {
  Solid solid{};
  std::apply([&](const auto&... field) { ((solid.*field.member = read_length(table, field)), ...); },
             Solid::fields);
  return solid;
}

using Hull = std::shared_ptr<const rigid::PolyhedronMesh>;

Hull hull_of_vertices(TableReader& table) {
  const auto points =
      table.points("vertices", 4, std::size_t(-1), "a list of at least 4 points, [[x, y, z], ...]");
  if (points.empty()) return {};
  const auto hull = adapters::convex_hull(points);
  for (std::size_t i = 0; i < points.size(); ++i)
    if (!std::binary_search(hull.corners.begin(), hull.corners.end(), static_cast<int>(i)))
      throw std::invalid_argument(
          fmt::format("vertex {} (counted from 0) is no corner of the hull of all: it lies inside, on a face "
                      "or an edge, or is given twice; remove it",
                      i));
  return hull.mesh;
}

/// Reads a polyhedron, which has corners instead of sizes.
rigid::ConvexShape read_polyhedron(TableReader& table) {
  const std::string given = table.one_of(
      {"vertices", "file"}, true, "its corners, [[x, y, z], ...], or the name of an STL, OBJ or PLY file");
  if (given != "file")
    table.refuse_given({"scale"},
                       "{key} goes with a file; the vertices are in the units of the case already");
  Hull mesh;
  try {
    if (given == "vertices") mesh = hull_of_vertices(table);
    if (given == "file") mesh = read_polyhedron_file(table);
  } catch (const std::invalid_argument& error) {
    table.fail(given, "{}: {}", table.path(given), error.what());
  }
  if (!mesh) return rigid::Sphere{1};  // the fault has been reported
  return rigid::Polyhedron{mesh};
}

/// Calls f with every type of ConvexShape for cases; half-spaces are for sides of the domain only.
template <class F, class... S>
void for_types(F&& f, const std::variant<S...>&) {
  const auto call = [&]<class T>(std::type_identity<T> type) {
    if constexpr (!std::is_same_v<T, rigid::HalfSpace>) f(type);
  };
  (call(std::type_identity<S>{}), ...);
}

std::vector<std::string> convex_names() {
  std::vector<std::string> names;
  for_types([&]<class S>(std::type_identity<S>) { names.emplace_back(S::name); }, rigid::ConvexShape());
  return names;
}

rigid::ConvexShape read_convex(TableReader& table, const std::string& name) {
  rigid::ConvexShape shape;
  const auto read = [&]<class S>(std::type_identity<S>) {
    if (name != S::name) return;
    if constexpr (std::is_same_v<S, rigid::Polyhedron>)
      shape = read_polyhedron(table);
    else
      shape = read_sizes<S>(table);
  };
  for_types(read, rigid::ConvexShape());
  return shape;
}

std::vector<std::string> shape_types() {
  auto names = convex_names();
  names.emplace_back(rigid::Compound::name);
  names.emplace_back(rigid::Mesh::name);
  return names;
}

rigid::Compound read_compound(TableReader& table) {
  rigid::Compound compound;
  table.need("parts", "a list of tables, { type = \"capsule\", ..., orientation = [1, 0, 0] }");
  if (const Node* given = table.find("parts");
      given && given->kind == Node::Kind::array && given->children.empty())
    table.refuse("parts", "a list of at least one table");
  for (TableReader& part : table.tables("parts")) {
    part.need("type", "one of " + joined(convex_names()));
    const auto type = part.choice("type", convex_names());
    if (!type) part.judge_no_keys();
    if (!type) continue;
    rigid::Pose pose;
    read_keys(part, pose, part_keys);
    pose.orientation = read_orientation(part);
    compound.parts.push_back({read_convex(part, *type), pose});
  }
  return compound;
}

/// Reads the last shape of a case.
rigid::Shape read_shape(TableReader& table, const std::string& type, Case& setup) {
  if (type == rigid::Compound::name) return read_compound(table);
  if (type == rigid::Mesh::name) return read_mesh_body(table, setup);
  return read_convex(table, type);
}

}  // namespace

std::vector<KeySection> shape_sections() {
  return {section_of("shapes", shape_keys), section_of("shapes.parts", part_keys, orientation_keys),
          section_of("bodies.orientation", turn_keys)};
}

rigid::Tube read_tube(TableReader& table) {
  return read_sizes<rigid::Tube>(table);
}

Quat read_orientation(TableReader& table) {
  const char* const key = "orientation";
  const Node* node = table.find(key);
  if (!node) return Quat::Identity();
  if (node->kind == Node::Kind::table) {
    TableReader turn = table.table(key);
    Turn about;
    read_keys(turn, about, turn_keys);
    if (turn.has("axis") && about.axis.norm() == 0) turn.refuse("axis", "a direction, not all 0");
    if (about.axis.norm() > 0) {
      const double half = about.degrees * std::numbers::pi / 360;
      const Vec3 v = rigid::elementary::sin(half) * about.axis.normalized();
      return Quat(rigid::elementary::cos(half), v[0], v[1], v[2]).normalized();
    }
  } else if (const auto q = node->numbers(4)) {
    const Quat orientation((*q)[0], (*q)[1], (*q)[2], (*q)[3]);
    if (orientation.norm() > 0) return orientation.normalized();
    table.refuse(key, "a quaternion, [w, x, y, z], not all 0");
  } else if (const auto x = node->numbers(3)) {
    const Vec3 axis((*x)[0], (*x)[1], (*x)[2]);
    if (axis.norm() > 0) return rigid::rotation_between(Vec3::UnitZ(), axis).normalized();
    table.refuse(key, "a direction of the z axis, [x, y, z], not all 0");
  } else {
    table.refuse(key,
                 "a direction of the z axis, [x, y, z], a quaternion, [w, x, y, z], or axis and angle, { "
                 "axis = [x, y, z], degrees = ... }");
  }
  return Quat::Identity();
}

void read_shapes(TableReader& root, Case& setup) {
  for (TableReader& table : root.tables("shapes")) {
    table.need("name", "name of the shape, to which bodies refer");
    table.need("type", "one of " + joined(shape_types()));
    read_new_name(table, setup.shape_names, "shape");
    rigid::Shape shape = rigid::Sphere{1};
    const Node* given = table.find("type");
    std::optional<std::string> type;
    if (given && given->kind == Node::Kind::string && given->string == rigid::HalfSpace::name)
      table.fail("type",
                 "{} is \"half-space\"; a body cannot be one: walls come from domain.boundary, a body's "
                 "shape is one of {}",
                 table.path("type"), joined(shape_types()));
    else
      type = table.choice("type", shape_types());
    if (type)
      shape = read_shape(table, *type, setup);
    else
      table.judge_no_keys();
    // about its centre of mass, however far from the origin of the case
    const Vec3 centre = rigid::mass_properties(shape).centre;
    setup.shapes.push_back(centre.isZero(0) ? shape : rigid::recentred(shape, centre));
    setup.shape_origins.push_back(-centre);
  }
}

}  // namespace silt
