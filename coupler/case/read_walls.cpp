// [[walls]]
#include <fmt/format.h>

#include <algorithm>

#include "coupler/case/case_sections.hpp"
#include "rigid/shapes/tube.hpp"

namespace silt::coupler {
namespace {

using rigid::Vec3;

/// "x", "y", "z", or a direction.
Vec3 read_axis(TableReader& table) {
  const Node* node = table.find("axis");
  if (!node) {
    table.missing("axis", "the direction of the tube: \"x\", \"y\", \"z\" or [x, y, z]");
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

std::string read_name(TableReader& table, const std::vector<CurvedWall>& walls) {
  const std::string name = table.string("name").value_or(table.path());
  for (const CurvedWall& other : walls)
    if (other.name == name)
      table.fail("name", fmt::format("{}: there already is a wall '{}'", table.path("name"), name));
  return name;
}

}  // namespace

void read_walls(TableReader& root, const std::vector<std::string>& material_names,
                std::vector<CurvedWall>& walls) {
  for (TableReader& table : root.tables("walls")) {
    CurvedWall wall;
    if (!table.has("type")) table.missing("type", "\"tube\"");
    if (!table.choice("type", {"tube"})) table.judge_no_keys();
    wall.name = read_name(table, walls);
    rigid::TubeSpec& tube = wall.tube;
    tube.radius = read_tube(table).radius;
    if (!table.has("point")) table.missing("point", "a point of the tube's axis, [x, y, z]");
    tube.point = table.vector("point", dimension::length).value_or(tube.point);
    tube.axis = read_axis(table);
    tube.material = read_material_name(table, material_names);
    tube.angular_velocity =
        table.quantity("angular_velocity", dimension::angular_velocity, range::any).value_or(0);
    tube.velocity = table.quantity("velocity", dimension::velocity, range::any).value_or(0);
    walls.push_back(wall);
  }
}

}  // namespace silt::coupler
