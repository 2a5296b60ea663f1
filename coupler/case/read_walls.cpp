// [[walls]]
#include <fmt/format.h>

#include <algorithm>

#include "coupler/case/case_sections.hpp"
#include "rigid/shapes/tube.hpp"

namespace silt::coupler {
namespace {

using rigid::Vec3;

std::string read_name(TableReader& table, const std::vector<CurvedWall>& walls) {
  const std::string name = table.string("name").value_or(table.path());
  for (const CurvedWall& other : walls)
    if (other.name == name)
      table.fail("name", fmt::format("{}: there already is a wall '{}'", table.path("name"), name));
  return name;
}

rigid::TubeSpec read_tube_wall(TableReader& table) {
  rigid::TubeSpec tube;
  tube.radius = read_tube(table).radius;
  if (!table.has("point")) table.missing("point", "a point of the tube's axis, [x, y, z]");
  tube.point = table.vector("point", dimension::length).value_or(tube.point);
  tube.axis = read_axis(table, "the direction of the tube");
  tube.angular_velocity =
      table.quantity("angular_velocity", dimension::angular_velocity, range::any).value_or(0);
  tube.velocity = table.quantity("velocity", dimension::velocity, range::any).value_or(0);
  return tube;
}

}  // namespace

/// "x", "y", "z", or a direction.
Vec3 read_axis(TableReader& table, std::string_view what) {
  const Node* node = table.find("axis");
  if (!node) {
    table.missing("axis", fmt::format("{}: \"x\", \"y\", \"z\" or [x, y, z]", what));
    return Vec3::UnitZ();
  }
  if (node->kind == Node::Kind::string) {
    const auto name = table.choice("axis", {"x", "y", "z"});
    return Vec3::Unit(name ? (*name)[0] - 'x' : 2);
  }
  const Vec3 axis = table.vector("axis").value_or(Vec3::UnitZ());
  if (axis.norm() > 0) return axis.normalized();
  table.refuse("axis", "\"x\", \"y\", \"z\" or a direction [x, y, z] that is not zero");
  return Vec3::UnitZ();
}

void read_walls(TableReader& root, const std::vector<std::string>& material_names,
                std::vector<CurvedWall>& walls) {
  for (TableReader& table : root.tables("walls")) {
    CurvedWall wall;
    if (!table.has("type")) table.missing("type", "\"tube\" or \"mesh\"");
    const auto type = table.choice("type", {"tube", "mesh"});
    if (!type) table.judge_no_keys();
    wall.name = read_name(table, walls);
    const int material = read_material_name(table, material_names);
    if (type == "mesh") {
      MeshWall mesh = read_mesh_wall(table);
      mesh.material = material;
      if (mesh.mesh.surface) wall.surface = std::move(mesh);  // else what is wrong has been said
    } else {
      rigid::TubeSpec tube = read_tube_wall(table);
      tube.material = material;
      wall.surface = tube;
    }
    walls.push_back(std::move(wall));
  }
}

}  // namespace silt::coupler
