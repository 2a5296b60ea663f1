// [[shapes]], and the orientation of a part or a body.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <stdexcept>

#include "adapters/qhull/convex_hull.hpp"
#include "coupler/case/case.hpp"
#include "coupler/case/case_sections.hpp"
#include "rigid/math/elementary.hpp"
#include "rigid/math/twist.hpp"
#include "rigid/shapes/shape.hpp"

namespace silt::coupler {

namespace {

using rigid::Quat;
using rigid::Vec3;

constexpr std::tuple shape_keys{
    HandKey{"name", "string", "", required, "what bodies call the shape"},
    HandKey{"type", "type of shape", "", required, "one of the table below, which says what else it takes"},
    HandKey{"radius", "number", "m", "one of two", "size of what is round"},
    HandKey{"diameter", "number", "m", "one of two", "size of what is round"},
    HandKey{"length", "number", "m", required,
            "of a cylinder from end to end; of a capsule between the centres of its ends; along z"},
    HandKey{"height", "number", "m", required,
            "of a cone from its base to its apex, along z; its origin is its centre of mass, a quarter of "
            "the height above the base"},
    HandKey{"edges", "[x, y, z]", "m", required, "edges of a box"},
    HandKey{"diameters", "[x, y, z]", "m", required, "of an ellipsoid, along its axes"},
    HandKey{"vertices", "[[x, y, z], …]", "m", "one of two", "corners of a convex body, in any order"},
    HandKey{"file", "string", "", "one of two",
            "STL, OBJ or PLY file in the directory of the case, closed, of a polyhedron convex; required of "
            "a mesh; a resumed run needs the same file"},
    HandKey{"scale", "number", "1", "1", "unit of length of the file in that of the case"},
    HandKey{"parts", "list of tables", "", required, "convex parts of a compound, see below"}};
constexpr std::tuple part_keys{
    HandKey{"position", "[x, y, z]", "m", "0", "of the part's origin, in the frame of the shape"}};

/// A rotation that an orientation is given by.
struct Turn {
  Vec3 axis = Vec3::Zero();
  double degrees = 0;
};
constexpr std::tuple turn_keys{Key{"axis", &Turn::axis, Vector{}, "what to turn about, [x, y, z]", required},
                               Key{"degrees", &Turn::degrees, Number{dimension::none, range::any, "degrees"},
                                   "how far to turn about the axis", required}};

/// Where it is not given or wrong, which is reported, some size that does no harm.
template <class Solid>
double read_length(TableReader& table, const rigid::Field<Solid, double>& field) {
  std::string given = field.key;
  if (field.other_key)
    given = table.one_of({field.key, field.other_key}, true, field.doc);
  else if (!table.has(field.key))
    table.missing(field.key, field.doc);
  const double share = given == field.key ? field.share : field.other_share;
  return (given.empty() ? 2 : table.quantity(given, dimension::length, range::above(0)).value_or(2)) * share;
}

template <class Solid>
Vec3 read_length(TableReader& table, const rigid::Field<Solid, Vec3>& field) {
  if (!table.has(field.key)) table.missing(field.key, field.doc);
  const Vec3 lengths = table.vector(field.key, dimension::length).value_or(Vec3::Ones());
  if (lengths.minCoeff() <= 0) table.refuse(field.key, "above 0 in each direction");
  return field.share * lengths;
}

/// The lengths that its table of fields names.
template <class Solid>
Solid read_sizes(TableReader& table) {
  Solid solid{};
  std::apply([&](const auto&... field) { ((solid.*field.member = read_length(table, field)), ...); },
             Solid::fields);
  return solid;
}

/// In lattice units; none where something is wrong with one (reported).
std::vector<Vec3> read_vertices(TableReader& table, const Units& units) {
  const Node* node = table.find("vertices");
  if (node->kind != Node::Kind::array || node->children.size() < 4) {
    table.refuse("vertices", "a list of at least 4 points, [[x, y, z], ...]");
    return {};
  }
  std::vector<Vec3> points;
  for (std::size_t i = 0; i < node->children.size(); ++i)
    if (const auto x =
            read_vector(table.context(), node->children[i], fmt::format("{}[{}]", table.path("vertices"), i)))
      points.push_back(*x / units.cell_size);
  return points.size() == node->children.size() ? points : std::vector<Vec3>{};
}

using Hull = std::shared_ptr<const rigid::PolyhedronMesh>;

Hull hull_of_vertices(TableReader& table, const Units& units) {
  const auto points = read_vertices(table, units);
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

/// A polyhedron has no sizes, but corners.
rigid::ConvexShape read_polyhedron(TableReader& table) {
  const std::string given = table.one_of(
      {"vertices", "file"}, true, "its corners, [[x, y, z], ...], or the name of an STL, OBJ or PLY file");
  if (given != "file" && table.has("scale"))
    table.fail("scale", "{} goes with a file; the vertices are in the units of the case already",
               table.path("scale"));
  Hull mesh;
  try {
    if (given == "vertices") mesh = hull_of_vertices(table, table.context().units);
    if (given == "file") mesh = read_polyhedron_file(table);
  } catch (const std::invalid_argument& error) {
    table.fail(given, "{}: {}", table.path(given), error.what());
  }
  if (!mesh) return rigid::Sphere{1};  // what is wrong has been said
  return rigid::Polyhedron{mesh};
}

/// An alternative of ConvexShape or HollowShape.
template <class Any>
struct Type {
  std::string name;
  Any (*read)(TableReader&);
};

template <class S, class Any>
void add_type(std::vector<Type<Any>>& types) {
  if constexpr (std::is_same_v<S, rigid::Polyhedron>)
    types.push_back({std::string(S::name), read_polyhedron});
  else if constexpr (!std::is_same_v<S, rigid::HalfSpace>)  // only walls are half-spaces
    types.push_back({std::string(S::name), [](TableReader& table) -> Any { return read_sizes<S>(table); }});
}

template <class Any, class... S>
std::vector<Type<Any>> types_of(const std::variant<S...>&) {
  std::vector<Type<Any>> types;
  (add_type<S>(types), ...);
  return types;
}

template <class Any>
const std::vector<Type<Any>>& types_of() {
  static const std::vector<Type<Any>> types = types_of<Any>(Any());
  return types;
}

template <class Any>
std::vector<std::string> names_of_types() {
  std::vector<std::string> names;
  for (const Type<Any>& type : types_of<Any>()) names.push_back(type.name);
  return names;
}

template <class Any>
Any read_type(TableReader& table, const std::string& name) {
  const auto& types = types_of<Any>();
  return std::ranges::find(types, name, &Type<Any>::name)->read(table);
}

std::vector<std::string> convex_names() {
  return names_of_types<rigid::ConvexShape>();
}

std::vector<std::string> shape_types() {
  auto names = convex_names();
  names.emplace_back(rigid::Compound::name);
  names.emplace_back(rigid::Mesh::name);
  return names;
}

rigid::Compound read_compound(TableReader& table) {
  rigid::Compound compound;
  if (!table.has("parts"))
    table.missing("parts", "a list of tables, { type = \"capsule\", ..., axis = [1, 0, 0] }");
  for (TableReader& part : table.tables("parts")) {
    if (!part.has("type")) part.missing("type", "one of " + joined(convex_names()));
    const auto type = part.choice("type", convex_names());
    if (!type) part.judge_no_keys();
    if (!type) continue;
    rigid::Pose pose;
    pose.position = part.vector("position", dimension::length).value_or(Vec3::Zero());
    pose.orientation = read_orientation(part);
    compound.parts.push_back({read_type<rigid::ConvexShape>(part, *type), pose});
  }
  if (compound.parts.empty() && table.has("parts"))
    table.fail("parts", table.path("parts") + " has no usable part");
  return compound;
}

rigid::Shape read_shape(TableReader& table, const std::string& type) {
  if (type == rigid::Compound::name) return read_compound(table);
  if (type == rigid::Mesh::name) return read_mesh_body(table);
  return read_type<rigid::ConvexShape>(table, type);
}

}  // namespace

std::vector<KeySection> shape_sections() {
  return {section_of("shapes", shape_keys), section_of("shapes.parts", part_keys, orientation_keys),
          section_of("bodies.axis_angle", turn_keys)};
}

rigid::HollowShape read_hollow(TableReader& table, const std::string& name) {
  return read_type<rigid::HollowShape>(table, name);
}

std::vector<std::string> hollow_names() {
  return names_of_types<rigid::HollowShape>();
}

Quat read_orientation(TableReader& table) {
  const std::string given = table.one_of({"orientation", "axis_angle", "axis"}, false, "");
  if (given == "orientation") {
    const Node* node = table.find(given);
    double q[4] = {};
    bool good = node->kind == Node::Kind::array && node->children.size() == 4;
    for (int i = 0; good && i < 4; ++i) {
      good = node->children[i].is_number() && std::isfinite(node->children[i].number());
      if (good) q[i] = node->children[i].number();
    }
    const Quat orientation(q[0], q[1], q[2], q[3]);
    if (good && orientation.norm() > 0) return orientation.normalized();
    table.refuse(given, "a quaternion of four numbers, [w, x, y, z], not all 0");
  } else if (given == "axis_angle") {
    TableReader turn = table.table(given);
    Turn about;
    read_keys(turn, about, turn_keys);
    if (turn.has("axis") && about.axis.norm() == 0) turn.refuse("axis", "a direction, not all 0");
    if (about.axis.norm() > 0) {
      const double half = about.degrees * std::numbers::pi / 360;
      const Vec3 v = rigid::elementary::sin(half) * about.axis.normalized();
      return Quat(rigid::elementary::cos(half), v[0], v[1], v[2]).normalized();
    }
  } else if (given == "axis") {
    const auto axis = table.vector(given);
    if (axis && axis->norm() > 0) return rigid::rotation_between(Vec3::UnitZ(), *axis).normalized();
    if (axis) table.refuse(given, "a direction, not all 0");
  }
  return Quat::Identity();
}

namespace {

/// Puts a shape about its centre of mass: however far it is from the origin that the case gives it about.
void add_centred(const rigid::Shape& given, Case& scene) {
  const Vec3 centre = rigid::mass_properties(given).centre;
  scene.shapes.push_back(centre.isZero(0) ? given : rigid::recentred(given, centre));
  scene.shape_origins.push_back(-centre);
}

}  // namespace

void read_shapes(TableReader& root, Case& scene) {
  for (TableReader& table : root.tables("shapes")) {
    if (!table.has("name")) table.missing("name", "what bodies call the shape");
    if (!table.has("type")) table.missing("type", "one of " + joined(shape_types()));
    const std::string name = table.string("name").value_or("");
    rigid::Shape shape = rigid::Sphere{1};
    if (table.has("type") && table.find("type")->kind == Node::Kind::string &&
        table.find("type")->string == rigid::HalfSpace::name) {
      table.fail("type",
                 "{} is \"half-space\"; a body cannot be one: walls come from domain.boundary, a body's "
                 "shape is one of {}",
                 table.path("type"), joined(shape_types()));
      table.judge_no_keys();
    } else if (const auto type = table.choice("type", shape_types())) {
      shape = read_shape(table, *type);
    } else {
      table.judge_no_keys();
    }
    add_centred(shape, scene);
    std::vector<std::string>& names = scene.shape_names;
    if (std::count(names.begin(), names.end(), name))
      table.fail("name", "{}: there already is a shape '{}'", table.path("name"), name);
    names.push_back(name);
  }
}

}  // namespace silt::coupler
